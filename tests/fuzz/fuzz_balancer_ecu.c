/**
 * The whole application of a balancing robot under frames of the input's choice, sound, spoilt and foreign, with
 * samples of any content: what must hold after each frame and tick is in tests/support/ecu_under_traffic.h, among it
 * that the motors run only for an operator who said so, told a second time by command_oracle.h.
 */
#include "tests/fuzz/fuzz_random.h"

#include "sim/balancer/robot_file.h"
#include "sim/bus/plant_node.h"
#include "tests/support/ecu_under_traffic.h"
#include "unity.h"

#define FRAMES 2000U

void setUp(void)
{
}

void tearDown(void)
{
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    if (!TEST_PROTECT()) {
        fuzz_require(false, "a failed assertion, above");
    }
    fuzz_random_begin(bytes, size);
    robot = rig_find_robot(one_in(2) ? "courier24" : "gao2018");
    fuzz_require(robot != NULL, "no such robot");
    memset(&controller, 0, sizeof controller);
    begin_episode(&controller);
    for (unsigned i = 0; i < FRAMES; i++) {
        execute(&controller);
    }
    return 0;
}
