/** Scenarios with any content: a scenario is taken, or refused with one line on stderr. */
#include "sim/missions/scenario.h"
#include "tests/fuzz/fuzz_file.h"

static bool load(const char *path)
{
    static struct scenario scenario;

    return scenario_load(path, &scenario);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    fuzz_file_load(bytes, size, load);
    return 0;
}
