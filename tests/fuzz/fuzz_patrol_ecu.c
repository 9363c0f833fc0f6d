/**
 * The whole application of the patrol robot, with scanner, localiser and maps, on a bus on which an operator and
 * strangers say anything and samples and scans hold anything: it runs only after somebody said so, and its wheels are
 * told angles and speeds within their limits.
 */
#include "sim/bus/ecu_node.h"
#include "tests/fuzz/fuzz_bus.h"

#define STEPS 200U

static struct ecu_node node;
static struct fuzz_bus bus;
static struct jp_wheel_targets targets;
static struct jp_four_wheel_actuation actuation;
static const struct patrol_robot_entry *entry;

static void check_targets(void)
{
    const struct jp_four_wheel_config *wheels = &entry->config->wheels;

    for (unsigned i = 0; i < (unsigned)JP_WHEELS; i++) {
        /* A signal has coarser steps than a set-point. */
        const int32_t step = 1 << 20;

        fuzz_require(actuation.wheels.angle[i] <= wheels->steering_limit + step &&
                         actuation.wheels.angle[i] >= -wheels->steering_limit - step,
                     "an angle beyond the limit");
        fuzz_require(actuation.wheels.speed[i] <= wheels->speed_max + JP_Q24(0.01) &&
                         actuation.wheels.speed[i] >= -wheels->speed_max - JP_Q24(0.01),
                     "a wheel too fast");
    }
    fuzz_require(actuation.enabled == 0U || bus.was_told_to_run, "drives that nobody told to run");
}

static enum jp_status take(void *context, const struct jp_can_frame *frame)
{
    bool is_whole = false;

    (void)context;
    fuzz_require(frame->length <= JP_CAN_LENGTH_MAX && frame->id < 0x800U, "a frame that is none");
    if (frame->id == JP_CAN_WHEEL_TARGET_FRAME_ID) {
        (void)jp_wheel_targets_accept(&targets, frame, &actuation, &is_whole);
        if (is_whole) {
            check_targets();
        }
    }
    return JP_OK;
}

static enum jp_can_state state(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

static const struct jp_can_port port = {.send = take, .state = state};

/** The drives do what they are told, more or less. */
static void tick(struct jp_four_wheel_sensors *sensors, uint8_t *counter, int32_t count)
{
    struct jp_can_frame frames[JP_WHEEL_SAMPLE_FRAMES];

    for (unsigned i = 0; i < (unsigned)JP_WHEELS; i++) {
        sensors->angle[i] = actuation.wheels.angle[i];
        sensors->count[i] += (uint32_t)count;
    }
    jp_wheel_sample_pack(frames, counter, sensors);
    for (unsigned i = 0; i < JP_WHEEL_SAMPLE_FRAMES; i++) {
        (void)jp_ecu_accept(bus.ecu, &frames[i]);
    }
    jp_ecu_tick(bus.ecu);
    fuzz_require(!jp_ecu_runs(bus.ecu) || bus.was_told_to_run, "a robot that nobody told to run");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    struct jp_four_wheel_sensors sensors = {.bus_current = 0};
    uint8_t counter = 0;
    int32_t count = 0;

    entry = patrol_robot_built_in("patrol");
    fuzz_require(entry != NULL, "no such robot");
    memset(&bus, 0, sizeof bus);
    memset(&targets, 0, sizeof targets);
    memset(&actuation, 0, sizeof actuation);
    fuzz_require(ecu_node_init_patrol(&node, entry, &port, NULL, NULL), "a robot that cannot be started");
    bus.ecu = &node.lockstep.ecu;
    bus.resolution = JP_PATROL_RESOLUTION;
    bus.beams = entry->scanner->beams <= FUZZ_BEAMS ? entry->scanner->beams : 0;
    sensors.bus_voltage = (entry->config->limits.voltage_min + entry->config->limits.voltage_max) / 2;
    for (unsigned step = 0; step < STEPS && fuzz_more(&input); step++) {
        if (fuzz_below(&input, 4) != 0U) {
            fuzz_bus_step(&bus, &input);
        } else if (fuzz_bool(&input)) {
            count = (int8_t)fuzz_u8(&input);
        } else {
            FUZZ_CHANGE(&input, sensors);
        }
        for (unsigned left = 1U + fuzz_below(&input, 16); left > 0U; left--) {
            tick(&sensors, &counter, count);
        }
        jp_ecu_work(bus.ecu);
    }
    return 0;
}
