/* What energy is saved at what length, driven: energy-optimal and distance-optimal plans on the 20 scenes, along
 * lattice_path.h in closed loop over the terrain, by the plant's ledger. Prints figures as JSON; --rows FILE gets the
 * curve of the prices and every drive. */
#include <jansson.h>

#include "sim/base/parallel.h"
#include "tests/bench/figures.h"
#include "tests/bench/priced_lattice.h"
#include "tests/bench/statistics.h"
#include "tests/support/path_rig.h"

#define COMMAND_DRIVE "make bench-skid-drive"
#define ROBOT_FILE    "sim/robots/zhang2018.cfg"

enum {
    PIECES = 1024,
    PLANS = PRICES + 1, /* the last is distance-optimal */
    SHORTEST = PRICES
};

/* A plan, and the drive along it. */
struct drive {
    double planned;  /* J by the lattice's tables */
    double foretold; /* J by jp_path_plan_speeds() */
    double energy;   /* J out of the battery */
    double length;   /* m on the map */
    double seconds;
    double foreseen_s; /* by jp_path_plan_speeds() */
    double worst;      /* m from the set-point */
    unsigned pieces;
    unsigned turns; /* of these, on the spot */
};

struct bench {
    struct scene scenes[SCENE_BENCH_COUNT];
    struct priced_lattice priced[PRICES];
    struct skid_steer_model model;
    struct drive drives[PLANS][SCENE_BENCH_COUNT];
};

static void plan_path(const struct jp_planner_config *config, const struct task *task, struct jp_lattice_path *path,
                      struct jp_path_piece *pieces, struct drive *drive)
{
    struct jp_planner planner;
    void *block = allocate(FULL_KIB * KIB);

    start_planner(&planner, config, task, block, FULL_KIB * KIB);
    (void)work_until_idle(&planner);
    if (jp_lattice_path_of_plan(path, &planner, pieces, PIECES) != JP_OK) {
        fail("a plan is no path");
    }
    drive->planned = route_of(&planner).energy;
    free(block);
}

static void drive_path(const struct skid_steer_model *model, const struct task *task, struct jp_lattice_path *path,
                       struct drive *drive)
{
    const struct jp_motion_price price = path_rig_price(model, &jp_skid_steer_zhang2018);
    const struct skid_ground ground = skid_ground_map(task->terrain);
    struct jp_path_cost cost;
    struct path_rig rig;

    if (jp_path_plan_speeds(path, &jp_path_limits_zhang2018, &price, &cost) != JP_OK ||
        !path_rig_start(&rig, model, &jp_path_drive_zhang2018, &ground, path)) {
        fail("a path has no speeds");
    }
    path_rig_drive(&rig);
    if (rig.robot.plant.tipped) {
        fail("the robot has tipped");
    }
    drive->foretold = cost.energy / PATH_RIG_Q16;
    drive->foreseen_s = cost.duration / PATH_RIG_Q16;
    drive->energy = rig.robot.plant.state.ledger.battery;
    drive->length = rig.way;
    drive->seconds = rig.seconds;
    drive->worst = rig.worst_distance;
    drive->pieces = path->count;
    for (unsigned i = 0; i < path->count; i++) {
        drive->turns += path->pieces[i].kind != JP_PIECE_CURVE;
    }
}

static void plan_and_drive(void *context, size_t index)
{
    struct bench *bench = context;
    const size_t plan_index = index / SCENE_BENCH_COUNT;
    const struct task *task = &bench->scenes[index % SCENE_BENCH_COUNT].task;
    struct drive *drive = &bench->drives[plan_index][index % SCENE_BENCH_COUNT];
    const struct jp_planner_config config = {
        plan_index == SHORTEST ? lattice : &bench->priced[plan_index].lattice,
        plan_index == SHORTEST ? JP_COST_DISTANCE : JP_COST_PHYSICAL,
        {JP_EPSILON(1.35), JP_EPSILON_ONE},
    };
    struct jp_lattice_path path;
    struct jp_path_piece *pieces = allocate(PIECES * sizeof *pieces);

    plan_path(&config, task, &path, pieces, drive);
    drive_path(&bench->model, task, &path, drive);
    free(pieces);
}

static struct saving saving_of(const struct bench *bench, size_t plan_index)
{
    double energy[SCENE_BENCH_COUNT];
    double length[SCENE_BENCH_COUNT];

    for (size_t i = 0; i < SCENE_BENCH_COUNT; i++) {
        const struct drive *shortest = &bench->drives[SHORTEST][i];
        energy[i] = 100 * (1 - bench->drives[plan_index][i].energy / shortest->energy);
        length[i] = 100 * (bench->drives[plan_index][i].length / shortest->length - 1);
    }
    return (struct saving){mean(energy, SCENE_BENCH_COUNT), mean(length, SCENE_BENCH_COUNT)};
}

static void add_tracking(const struct bench *bench, json_t *figures)
{
    double foretold[PLANS * SCENE_BENCH_COUNT];
    double worst = 0;

    for (size_t i = 0; i < PLANS * SCENE_BENCH_COUNT; i++) {
        const struct drive *drive = &bench->drives[i / SCENE_BENCH_COUNT][i % SCENE_BENCH_COUNT];
        foretold[i] = 100 * (drive->energy / drive->foretold - 1);
        worst = fmax(worst, 100 * drive->worst);
    }
    figures_add(figures, COMMAND_DRIVE, worst, "cm", at_most(10),
                "skid steer driven on the 20 scenes: distance from the set-point, most");
    figures_add(figures, COMMAND_DRIVE, mean(foretold, PLANS * SCENE_BENCH_COUNT), "%", no_bar,
                "skid steer driven on the 20 scenes: energy above the closed formulas', mean");
}

static json_t *row_of(const struct bench *bench, size_t plan_index, size_t scene)
{
    const struct drive *drive = &bench->drives[plan_index][scene];

    return json_pack("{s:i, s:o, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:i, s:i}", "scene",
                     (int)(scene + SCENE_BENCH_FIRST), "price_j_per_m",
                     plan_index == SHORTEST ? json_null() : json_real(prices[plan_index]), "planned_j", drive->planned,
                     "foretold_j", drive->foretold, "driven_j", drive->energy, "length_m", drive->length, "planned_s",
                     drive->foreseen_s, "driven_s", drive->seconds, "worst_m", drive->worst, "pieces",
                     (int)drive->pieces, "turns", (int)drive->turns);
}

static void report(const struct bench *bench, json_t *figures, const char *rows_path)
{
    struct saving curve[PRICES];
    json_t *curve_rows = json_array();
    json_t *drives = json_array();

    for (size_t i = 0; i < PRICES; i++) {
        curve[i] = saving_of(bench, i);
        (void)json_array_append_new(curve_rows,
                                    json_pack("{s:f, s:f, s:f}", "price_j_per_m", prices[i], "saved_percent",
                                              curve[i].energy, "longer_percent", curve[i].length));
    }
    for (size_t i = 0; i < PLANS * SCENE_BENCH_COUNT; i++) {
        (void)json_array_append_new(drives, row_of(bench, i / SCENE_BENCH_COUNT, i % SCENE_BENCH_COUNT));
    }
    figures_write_rows(json_pack("{s:o, s:o}", "curve", curve_rows, "drives", drives), rows_path);
    figures_add(figures, COMMAND_DRIVE, curve[0].energy, "%", at_least(PAPER_SAVING),
                "energy-optimal against distance-optimal plans, driven on the 20 scenes: energy saved, mean");
    figures_add(figures, COMMAND_DRIVE, curve[0].length, "%", no_bar,
                "energy-optimal against distance-optimal plans, driven on the 20 scenes: longer by, mean");
    figures_add(figures, COMMAND_DRIVE, energy_at_length(curve, PAPER_LENGTH), "%", at_least(PAPER_SAVING),
                "the same driven with length priced so that drives are 3.7 %% longer: energy saved, mean");
    add_tracking(bench, figures);
}

int main(int argc, char **argv)
{
    static struct bench bench;
    const char *rows_path = figures_rows_path(argc, argv, "Drives plans of the skid-steered robot.");
    json_t *figures = json_array();

    if (!skid_robot_load(ROBOT_FILE, &bench.model)) {
        return 1;
    }
    for (unsigned i = 0; i < SCENE_BENCH_COUNT; i++) {
        make_scene(&bench.scenes[i], SCENE_BENCH_FIRST + i);
    }
    for (size_t i = 0; i < PRICES; i++) {
        bench.priced[i] = price_length(prices[i]);
    }
    in_parallel("drives", plan_and_drive, &bench, PLANS * SCENE_BENCH_COUNT);
    report(&bench, figures, rows_path);
    for (size_t i = 0; i < PRICES; i++) {
        free(bench.priced[i].primitives);
    }
    for (unsigned i = 0; i < SCENE_BENCH_COUNT; i++) {
        free(bench.scenes[i].block);
    }
    figures_print(figures);
    return 0;
}
