/** Instructions of a return map of 300 × 300 cells and 16 headings, out and back, by slices, over ground of which
 *  everything is free and level, and over the first scene of the bench. It does not fit into the memory of a
 *  microcontroller: its block is in the board's external memory. */
#include <joulepath/return_map.h>
#include <joulepath/tables.h>

#include "tests/support/scene.h"
#include "tests/target/cycles.h"
#include "tests/target/external.h"
#include "tests/target/figure.h"

/* What an STM32H7 at 400 MHz executes in 2 s at an instruction a cycle. */
#define BAR "800000"

#define SLICE    5000U
#define THOUSAND 1000U

static uint64_t map_block[(SCENE_TERRAIN_SIZE + 7) / 8];
static struct jp_terrain terrain;
static struct jp_return_map map;
static bool is_done;

static void work(void *argument)
{
    is_done = jp_return_map_work(argument, SLICE);
}

/** In thousands. */
static uint32_t count_map(const struct jp_lattice *lattice, const struct jp_lattice_pose *from)
{
    uint64_t instructions = 0;

    if (jp_return_map_init(&map, lattice, &terrain, target_external, TARGET_EXTERNAL_SIZE) != JP_OK ||
        jp_return_map_start(&map, from, from->x, from->y, JP_COST_MAX - 2U) != JP_OK) {
        target_print("no map\n");
        target_exit(1);
    }
    do {
        const uint32_t slice = target_count_once(work, &map);

        if (slice == TARGET_COUNT_OVERFLOW) {
            target_print("a slice is too long to be counted\n");
            target_exit(1);
        }
        instructions += slice;
    } while (!is_done);
    return (uint32_t)((instructions + THOUSAND - 1U) / THOUSAND);
}

static void make_level(void)
{
    struct jp_terrain_config config = scene_terrain_config;
    const char *field = "";

    config.has_elevation = false;
    (void)jp_terrain_init(&terrain, &config, map_block, sizeof map_block, &field);
    for (int32_t i = 0; i < SCENE_SIDE * SCENE_SIDE; i++) {
        (void)jp_terrain_set_cell(&terrain, i % SCENE_SIDE, i / SCENE_SIDE, JP_CELL_FREE);
    }
}

static uint32_t count_level(void)
{
    const struct jp_lattice_pose middle = {SCENE_SIDE / 2, SCENE_SIDE / 2, 0};

    make_level();
    return count_map(&jp_lattice_zhang2018, &middle);
}

static uint32_t count_scene(void)
{
    struct scene_task task;
    const char *field = "";

    (void)jp_terrain_init(&terrain, &scene_terrain_config, map_block, sizeof map_block, &field);
    scene_generate(SCENE_BENCH_FIRST, &terrain, &task);
    const struct jp_lattice_pose start = {(int16_t)task.start.x, (int16_t)task.start.y, task.start.heading};

    return count_map(&jp_lattice_zhang2018, &start);
}

int main(void)
{
    target_print("[\n");
    target_print_figure("return map, 300 x 300 cells, 16 headings, all free and level", count_level(),
                        "thousand instructions", BAR);
    target_print(",\n");
    target_print_figure("return map, 300 x 300 cells, 16 headings, the first scene", count_scene(),
                        "thousand instructions", BAR);
    target_print("\n]\n");
    return 0;
}
