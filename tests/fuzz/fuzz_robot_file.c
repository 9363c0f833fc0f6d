/**
 * Files of robots, of every kind, with any content: each reader takes the file, and says nothing, or refuses it with
 * one line on stderr.
 */
#include "sim/balancer/robot_file.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/skid_steer/skid_steer_model.h"
#include "tests/fuzz/fuzz_file.h"

static bool load_balancer(const char *path)
{
    static struct robot_file robot;

    return robot_file_load(path, &robot);
}

static bool load_skid(const char *path)
{
    static struct skid_steer_model model;

    return skid_robot_load(path, &model);
}

static bool load_four_wheel(const char *path)
{
    static struct four_wheel_file robot;
    const char *field = NULL;

    if (!four_wheel_file_load(path, &robot)) {
        return false;
    }

    const struct jp_four_wheel_config config = four_wheel_config(&robot);

    fuzz_require(jp_four_wheel_check(&config, &field) == JP_OK, "a robot that the core refuses");
    return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    fuzz_file_load(bytes, size, load_balancer);
    fuzz_file_load(bytes, size, load_skid);
    fuzz_file_load(bytes, size, load_four_wheel);
    return 0;
}
