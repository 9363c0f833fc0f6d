/**
 * The application plans on the core while its control tick comes by a timer: courier24, whose wheels are held, gets a
 * dense map of 192 × 192 cells over the bus, and is given one goal after the other and changes of cells, so that it
 * plans all the time; what it is about to drive is blocked again and again. No tick may begin or end late.
 *
 * Under -icount shift=3 an instruction takes 8 ns of the timer, as the mean of a Cortex-M4 at 168 MHz with 1.3 cycles.
 * The linker gives the number of ticks (planning_ticks); from FIGURES_FROM on it prints figures in place of tests.
 */
#include <joulepath/tables.h>

#include "hal/app/navigation_memory.h"
#include "hal/cortex_m/cortex_m.h"
#include "hal/cortex_m/fault.h"
#include "hal/stm32f4/timer.h"
#include "tests/support/ecu_start.h"
#include "tests/support/map_frames.h"
#include "tests/target/figure.h"
#include "tests/target/target.h"

/** SysTick counts at 168 MHz. */
#define PERIOD 168000U

/** Instructions of so many counts. */
#define INSTRUCTIONS(counts) ((uint32_t)((uint64_t)(counts)*1000U / 168U / 8U))

/** Of another timer, as QEMU has it; it is read to a tick. */
#define TIMER_HZ    1000000000U
#define US_A_TICK   1000U
#define TIMER_ERROR 2U

/** A tick that begins later is late. */
#define LATE (PERIOD / 100U)

#define SIDE   JP_NAVIGATION_SIDE
#define BOXES  80U
#define STREAM 10000U

#define GOAL_EVERY   4000U /* ticks, if it has not been reached on the map before */
#define CHANGE_EVERY 37U

/** The boxes on its way to a goal: so far ahead, so many cells a side, and so many of them. */
#define AHEAD     JP_Q16(1.5)
#define BOX_SIDE  5
#define BOXES_MAX 8U

/** Of the times from one course to the next. */
#define REPLANS_MAX 2048U

#define FIGURES_FROM 1000000U

/** A number that the linker has as an address. */
extern const uint8_t planning_ticks[];

#define BESIDE __attribute__((section(".ccm")))

static struct jp_ecu ecu;
static struct jp_ecu_balancer balancer;
static struct jp_navigation navigation;
static struct jp_navigation_block block;
BESIDE static struct jp_navigation_ground ground;
BESIDE static uint64_t world_memory[JP_NAVIGATION_WORDS];
BESIDE static uint8_t stream[STREAM];
static struct jp_terrain world;
static struct sent_map sent;
static uint32_t random_state = 12345;
static uint8_t command_counter;

/* Of the tick. */
static volatile uint32_t ticks;
static volatile uint32_t spent_in_tick; /* counts, all ticks */
static uint32_t worst_latency;
static uint32_t worst_tick;
static uint32_t late;

/* Of the background. */
static uint32_t worst_work;
static uint32_t worst_planning;
static uint32_t planning_slices;
static uint32_t goals;

/** Of the present goal, from the south-west; a bit for each cell that was free. */
static struct {
    int32_t x;
    int32_t y;
    uint32_t was_free;
} boxes[BOXES_MAX];
static uint32_t box_count;

/* From a blocked course to the next one. */
static bool is_replanning;
static uint32_t replan_counts; /* of its work until now */
static uint32_t replans[REPLANS_MAX];
static uint32_t replan_count;

void jp_bridges_off(void)
{
}

/* ---- Board and bus ---- */

static enum jp_status read_board(void *context, struct jp_sensors *sensors)
{
    const struct jp_voltages *voltages = &jp_robot_last_tick(&balancer.robot)->voltages;

    (void)context;
    random_state = random_state * 1664525U + 1013904223U;
    *sensors = (struct jp_sensors){
        .accel_x = (int32_t)(random_state >> 20) - 2048,
        .accel_z = JP_Q24_ONE + (int32_t)(random_state >> 19 & 0xFFFU) - 2048,
        .pitch_rate = (int32_t)(random_state >> 24) - 128,
        .yaw_rate = (int32_t)(random_state >> 16 & 0xFFU) - 128,
        .bus_voltage = JP_Q16(24),
        .current_left = jp_q16_divide(voltages->left, jp_robot_courier24.monitor.motor_resistance),
        .current_right = jp_q16_divide(voltages->right, jp_robot_courier24.monitor.motor_resistance)};
    return JP_OK;
}

static enum jp_status write_board(void *context, const struct jp_actuation *actuation)
{
    (void)context;
    (void)actuation;
    return JP_OK;
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    (void)context;
    (void)frame;
    return JP_OK;
}

static enum jp_can_state always_on(void *context)
{
    (void)context;
    return JP_CAN_ON;
}

/* ---- Time ---- */

/** Counts since the timer began that were not spent in the tick. */
static uint32_t background_time(void)
{
    uint32_t before;
    uint32_t counts;

    do {
        before = ticks;
        counts = PERIOD - 1U - SYSTICK.CVR - spent_in_tick;
    } while (before != ticks);
    return before * PERIOD + counts;
}

void SysTick_Handler(void)
{
    const uint32_t begin = PERIOD - 1U - SYSTICK.CVR;
    uint32_t end;

    (void)SYSTICK.CSR; /* forgets that the period has ended */
    jp_ecu_tick(&ecu);
    end = PERIOD - 1U - SYSTICK.CVR;
    late += begin > LATE || end < begin ? 1U : 0U;
    spent_in_tick += end - begin;
    ticks++;
    worst_latency = begin > worst_latency ? begin : worst_latency;
    worst_tick = end - begin > worst_tick ? end - begin : worst_tick;
}

/* ---- World ---- */

static uint32_t below(uint32_t limit)
{
    random_state = random_state * 1664525U + 1013904223U;
    return (uint32_t)(((uint64_t)random_state * limit) >> 32);
}

static void put_box(uint32_t x, uint32_t y, uint32_t width, uint32_t height, enum jp_cell cell)
{
    for (uint32_t v = y; v < y + height; v++) {
        for (uint32_t u = x; u < x + width; u++) {
            (void)jp_terrain_set_cell(&world, (int32_t)u, (int32_t)v, cell);
        }
    }
}

static void make_world(void)
{
    const struct jp_terrain_config config = {
        .width = SIDE, .height = SIDE, .resolution = jp_lattice_courier24.resolution};
    const struct jp_place origin = {{JP_Q16(1.05), JP_Q16(1.05)}, 0};
    const char *field;

    (void)jp_terrain_init(&world, &config, world_memory, sizeof world_memory, &field);
    put_box(0, 0, SIDE, SIDE, JP_CELL_OCCUPIED);
    put_box(1, 1, SIDE - 2, SIDE - 2, JP_CELL_FREE);
    for (uint32_t i = 0; i < BOXES; i++) {
        const bool is_wall = below(3) == 0U;

        put_box(below(SIDE), below(SIDE), is_wall ? 25 : 1U + below(8), is_wall ? 1 : 1U + below(8), JP_CELL_OCCUPIED);
    }
    put_box(3, 3, 16, 16, JP_CELL_FREE);
    sent = (struct sent_map){.bytes = stream, .id = 1};
    sent.length = (uint16_t)jp_map_encode(&world, &origin, stream, sizeof stream);
}

/* ---- The application ---- */

static void give(struct jp_can_frame frame)
{
    (void)jp_ecu_accept(&ecu, &frame);
}

/** While the robot gets ready; then it is commanded to go. */
static uint8_t mode = JP_MODE_STAND;

static bool is_planning(void)
{
    const enum jp_navigator_state state = navigation.navigator.state;

    return state == JP_NAVIGATOR_PLANNING || state == JP_NAVIGATOR_PROVING || state == JP_NAVIGATOR_JOINING;
}

/** After a slice of so many counts. */
static void note_replan(uint32_t counts)
{
    const bool was_replanning = is_replanning;

    is_replanning = is_planning() && navigation.navigator.replans > 0U;
    if (was_replanning || is_replanning) {
        replan_counts += counts;
    }
    if (was_replanning && navigation.navigator.state == JP_NAVIGATOR_TURNING && replan_count < REPLANS_MAX) {
        replans[replan_count] = replan_counts;
        replan_count++;
    }
    replan_counts = is_replanning ? replan_counts : 0U;
}

/** One slice of background work when a tick has come, as the firmware's main loop does. */
static void work(void)
{
    static uint32_t worked;
    const bool plans = navigation.navigator.state == JP_NAVIGATOR_PLANNING;

    while (worked == ticks) {
    }
    worked = ticks;
    if (worked % 100U == 0U) {
        give(operator_command(++command_counter & 15U, mode, 0));
    }
    const uint32_t begin = background_time();

    jp_ecu_work(&ecu);
    const uint32_t duration = background_time() - begin;

    note_replan(duration);
    worst_work = duration > worst_work ? duration : worst_work;
    if (plans) {
        planning_slices++;
        worst_planning = duration > worst_planning ? duration : worst_planning;
    }
}

static bool start(void)
{
    static const struct jp_hal board = {NULL, read_board, write_board};
    static const struct jp_can_port port = {NULL, send, always_on};
    static const struct jp_ecu_learning learning = {.learning = &jp_learning_courier24};
    const struct jp_navigation_config config =
        jp_navigation_config_of(&jp_lattice_courier24, &jp_navigation_courier24, &ground, &block);
    const char *field;

    if (ecu_start(&ecu, &balancer, &jp_robot_courier24, &jp_energy_model_courier24, &port, NULL, &field) != JP_OK ||
        jp_ecu_balancer_learn(&balancer, &learning, &field) != JP_OK ||
        navigation_start(&navigation, &config, &balancer.pilot, &field) != JP_OK) {
        return false;
    }
    jp_ecu_use_board(&ecu, &board);
    jp_ecu_navigate(&ecu, &navigation);
    jp_timer_start(TIMER_HZ);
    SCB.SHPR[11] = NVIC_PRIORITY(2);
    SYSTICK.RVR = PERIOD - 1U;
    SYSTICK.CVR = 0;
    SYSTICK.CSR = SYSTICK_CLKSOURCE | SYSTICK_TICKINT | SYSTICK_ENABLE;
    return true;
}

/** Until the robot stands and has the map. */
static bool prepare(void)
{
    uint32_t next = 0;

    give(map_offer(&sent));
    while (ticks < 20000U && navigation.maps.state != JP_MAP_LINK_READY) {
        work();
        if (navigation.maps.frames == next) {
            give(map_data(&sent, next));
            next++;
        } else {
            next = navigation.maps.frames;
        }
    }
    while (ticks < 20000U && jp_robot_state_now(&balancer.robot) != JP_ROBOT_BALANCING) {
        work();
    }
    return navigation.is_prepared && jp_robot_state_now(&balancer.robot) == JP_ROBOT_BALANCING;
}

/** As a sensor would, not round the robot. */
static void change_cell(void)
{
    const int32_t x = 25 + (int32_t)below(SIDE - 27U);
    const int32_t y = 1 + (int32_t)below(SIDE - 2U);
    const bool is_free = jp_terrain_cell(&navigation.maps.decoder.terrain, x, y) == JP_CELL_FREE;

    (void)jp_navigator_set_cell(&navigation.navigator, x, y, is_free ? JP_CELL_OCCUPIED : JP_CELL_FREE);
}

static void put_box_on_way(int32_t x, int32_t y)
{
    uint32_t was_free = 0;

    for (int32_t i = 0; i < BOX_SIDE * BOX_SIDE; i++) {
        const int32_t u = x + i % BOX_SIDE;
        const int32_t v = y + i / BOX_SIDE;

        if (jp_terrain_cell(&navigation.maps.decoder.terrain, u, v) == JP_CELL_FREE) {
            was_free |= UINT32_C(1) << i;
            (void)jp_navigator_set_cell(&navigation.navigator, u, v, JP_CELL_OCCUPIED);
        }
    }
    boxes[box_count].x = x;
    boxes[box_count].y = y;
    boxes[box_count].was_free = was_free;
    box_count++;
}

static void take_boxes_away(void)
{
    while (box_count > 0U) {
        box_count--;
        for (int32_t i = 0; i < BOX_SIDE * BOX_SIDE; i++) {
            if (((boxes[box_count].was_free >> i) & 1U) != 0U) {
                (void)jp_navigator_set_cell(&navigation.navigator, boxes[box_count].x + i % BOX_SIDE,
                                            boxes[box_count].y + i / BOX_SIDE, JP_CELL_FREE);
            }
        }
    }
}

/** A box on the first leg of the course that is long enough. */
static void block_way(void)
{
    uint16_t count;
    const struct jp_course_leg *legs = jp_navigator_legs(&navigation.navigator, &count);
    struct jp_point from = jp_navigator_place(&navigation.navigator).point;
    int64_t ahead = AHEAD;

    for (uint16_t i = 0; i < count; i++) {
        const struct jp_point *end = &legs[i].end;
        const int64_t dx = (int64_t)end->x - from.x;
        const int64_t dy = (int64_t)end->y - from.y;
        const int64_t length = (int64_t)jp_square_root((uint64_t)(dx * dx + dy * dy));

        if (length > ahead) {
            put_box_on_way((int32_t)((from.x + dx * ahead / length) / jp_lattice_courier24.resolution) - BOX_SIDE / 2,
                           (int32_t)((from.y + dy * ahead / length) / jp_lattice_courier24.resolution) - BOX_SIDE / 2);
            return;
        }
        ahead -= length;
        from = *end;
    }
}

/** To another place, whose way must be planned. */
static void send_on(void)
{
    struct jp_goal goal = {.headings = JP_ANY_HEADING};

    take_boxes_away();
    do {
        goal.x = (int16_t)below(SIDE);
        goal.y = (int16_t)below(SIDE);
    } while (goal.x + goal.y < SIDE / 2 || jp_navigator_go(&navigation.navigator, &goal) != JP_OK);
    goals++;
}

static bool has_no_goal(void)
{
    const enum jp_navigator_state state = navigation.navigator.state;

    return state == JP_NAVIGATOR_IDLE || state >= JP_NAVIGATOR_ARRIVED;
}

static void plan(uint32_t count)
{
    const uint32_t end = ticks + count;
    uint32_t goal_tick = ticks;

    mode = JP_MODE_NAVIGATE;
    give(operator_command(++command_counter & 15U, mode, 0));
    while (ticks < end) {
        const bool was_joining = navigation.navigator.state == JP_NAVIGATOR_JOINING;

        if (has_no_goal() || box_count == BOXES_MAX || ticks - goal_tick >= GOAL_EVERY) {
            goal_tick = ticks;
            send_on();
        }
        if (ticks % CHANGE_EVERY == 0U && !is_planning()) {
            change_cell();
        }
        work();
        if (was_joining && navigation.navigator.state == JP_NAVIGATOR_TURNING) {
            block_way();
        }
    }
}

/* ---- The result ---- */

static unsigned failures;

/** By the other timer, of the ticks since `from` those that never came. */
static uint32_t lost(uint32_t from, uint32_t from_us)
{
    const uint32_t came = ticks - from;
    const uint32_t passed = (jp_timer_us() - from_us) / US_A_TICK;

    return passed > came + TIMER_ERROR ? passed - came : 0U;
}

static void check(const char *name, bool is_right, uint32_t value)
{
    target_print("tests/firmware/test_planning.c:1:");
    target_print(name);
    target_print(is_right ? ":PASS\n" : ":FAIL: ");
    if (!is_right) {
        target_print_number(value);
        target_print("\n");
        failures++;
    }
}

static void sort_replans(void)
{
    for (uint32_t i = 1; i < replan_count; i++) {
        const uint32_t value = replans[i];
        uint32_t place = i;

        for (; place > 0U && replans[place - 1U] > value; place--) {
            replans[place] = replans[place - 1U];
        }
        replans[place] = value;
    }
}

static void print_figures(void)
{
    target_print("[\n");
    target_print_figure("ticks of 1 ms while it plans", ticks, "", NULL);
    target_print(",\n");
    target_print_figure("ticks late while it plans", late, "", "0");
    target_print(",\n");
    target_print_figure("from the timer to the tick while it plans, worst", INSTRUCTIONS(worst_latency), "instructions",
                        NULL);
    target_print(",\n");
    target_print_figure("application's tick, worst", INSTRUCTIONS(worst_tick), "instructions", NULL);
    target_print(",\n");
    target_print_figure("slice of the application's work while it plans, worst", INSTRUCTIONS(worst_planning),
                        "instructions", NULL);
    target_print(",\n");
    target_print_figure("slice of the application's work, worst", INSTRUCTIONS(worst_work), "instructions", NULL);
    target_print(",\n");
    target_print_figure("courses whose way was blocked, and for which there was another", replan_count, "", NULL);
    target_print(",\n");
    sort_replans();
    target_print_figure("from a blocked way to another course, its work at 168 MHz, median",
                        replans[replan_count / 2U] / PERIOD, "ms", NULL);
    target_print(",\n");
    target_print_figure("from a blocked way to another course, its work at 168 MHz, worst",
                        replans[replan_count - 1U] / PERIOD, "ms", "500");
    target_print("\n]\n");
}

static void print_tests(uint32_t count, uint32_t ticks_lost)
{
    check("it_planned_all_the_time", planning_slices > count / 4U, planning_slices);
    check("its_way_was_blocked_and_it_found_another", replan_count > 0U, replan_count);
    check("no_tick_was_late", late == 0U, late);
    check("no_tick_was_lost", ticks_lost == 0U, ticks_lost);
    check("the_rest_of_the_tick_is_left_for_work", worst_tick < PERIOD / 4U, INSTRUCTIONS(worst_tick));
    target_print_number(5);
    target_print(" Tests ");
    target_print_number(failures);
    target_print(" Failures 0 Ignored\n");
    target_print(failures == 0U ? "OK\n" : "FAIL\n");
}

int main(void)
{
    const uint32_t count = (uint32_t)(uintptr_t)planning_ticks;

    make_world();
    if (!start() || !prepare()) {
        target_print("tests/firmware/test_planning.c:1:it_gets_ready:FAIL: it has no map, or does not stand\n");
        target_exit(1);
    }
    const uint32_t from = ticks;
    const uint32_t from_us = jp_timer_us();

    plan(count);
    SYSTICK.CSR = 0;
    const uint32_t ticks_lost = lost(from, from_us);

    if (count >= FIGURES_FROM) {
        late += ticks_lost;
        print_figures();
    } else {
        print_tests(count, ticks_lost);
    }
    target_exit(failures == 0U ? 0 : 1);
}
