/**
 * The whole application of a robot that its sides steer, with its navigator, on a bus on which an operator and
 * strangers say anything and samples hold anything: it stands or drives only after somebody said so, and what it sends
 * is whole.
 */
#include "sim/bus/ecu_node.h"
#include "tests/fuzz/fuzz_bus.h"
#include "tests/fuzz/fuzz_sensors.h"

#define STEPS 300U

static struct ecu_node node;
static struct fuzz_bus bus;
static struct jp_e2e_receiver receiver;
static bool answers;

static enum jp_status take(void *context, const struct jp_can_frame *frame)
{
    struct jp_actuation actuation;

    (void)context;
    fuzz_require(frame->length <= JP_CAN_LENGTH_MAX && frame->id < 0x800U, "a frame that is none");
    if (frame->id == JP_CAN_MOTOR_COMMAND_FRAME_ID) {
        const enum jp_e2e_result result = jp_message_to_actuation(&receiver, frame, &actuation);

        fuzz_require(result == JP_E2E_OK || result == JP_E2E_FIRST, "a command that is not in its order");
    }
    return answers ? JP_OK : JP_ERR_BUSY;
}

static enum jp_can_state state(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

static const struct jp_can_port port = {.send = take, .state = state};

static void tick(struct fuzz_sensors *sensors, uint8_t *counter)
{
    struct jp_can_frame parts[JP_SAMPLE_PARTS];

    fuzz_sensors_move(sensors);
    jp_message_from_sensors(parts, counter, &sensors->frame);
    for (unsigned i = 0; sensors->read == JP_OK && i < (unsigned)JP_SAMPLE_PARTS; i++) {
        (void)jp_ecu_accept(bus.ecu, &parts[i]);
    }
    jp_ecu_tick(bus.ecu);
    fuzz_require(!jp_ecu_runs(bus.ecu) || bus.was_told_to_run, "a robot that nobody told to run");
    fuzz_require(jp_ecu_state_now(bus.ecu) <= JP_ECU_FAULT, "state of the robot");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct fuzz_input input = {.next = bytes, .left = size};
    const struct skid_robot_entry *entry = skid_robot_built_in(fuzz_bool(&input) ? "zhang2018" : "burger");
    struct fuzz_sensors sensors;
    uint8_t counter = 0;

    fuzz_require(entry != NULL, "no such robot");
    answers = true;
    memset(&receiver, 0, sizeof receiver);
    memset(&bus, 0, sizeof bus);
    fuzz_require(ecu_node_init_skid(&node, entry, &port, NULL, NULL), "a robot that cannot be started");
    bus.ecu = &node.lockstep.ecu;
    bus.resolution = entry->lattice->resolution;
    fuzz_sensors_begin(&sensors);
    sensors.frame.bus_voltage = (entry->config->monitor.voltage_min + entry->config->monitor.voltage_max) / 2;
    for (unsigned step = 0; step < STEPS && fuzz_more(&input); step++) {
        if (fuzz_bool(&input)) {
            fuzz_bus_step(&bus, &input);
        } else if (fuzz_below(&input, 4) == 0U) {
            fuzz_sensors_change(&sensors, &input);
        }
        for (unsigned left = 1U + fuzz_below(&input, 16); left > 0U; left--) {
            tick(&sensors, &counter);
        }
        answers = fuzz_below(&input, 32) != 31U;
        jp_ecu_work(bus.ecu);
    }
    return 0;
}
