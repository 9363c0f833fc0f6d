/* Drives a skid-steered or differential-drive robot with constant duties and says where its energy went. */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/output.h"
#include "sim/skid_steer/skid_world.h"

enum { LEFT = COMMAND_LINE_OWN, RIGHT, SECONDS, SLOPE, HEADING };

struct arguments {
    struct command_line common;
    double left;
    double right;
    double seconds;
    double slope_deg;
    double heading_deg;
};

/* A number of the result. */
struct figure {
    const char *key;
    const char *label;
    const char *unit;
    double value;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case LEFT:
        arguments->left = command_line_real(state, "--left", argument, -1, 1);
        return 0;
    case RIGHT:
        arguments->right = command_line_real(state, "--right", argument, -1, 1);
        return 0;
    case SECONDS:
        arguments->seconds = command_line_real(state, "--seconds", argument, 0.01, 3600);
        return 0;
    case SLOPE:
        arguments->slope_deg = command_line_real(state, "--slope", argument, 0, 60);
        return 0;
    case HEADING:
        arguments->heading_deg = command_line_real(state, "--heading", argument, -180, 180);
        return 0;
    case ARGP_KEY_ARG:
        command_line_take_robot(state, argument, &arguments->common);
        return 0;
    case ARGP_KEY_NO_ARGS:
        command_line_refuse(state, "a robot is needed, such as zhang2018");
    default:
        return command_line_option(key, argument, state, &arguments->common);
    }
}

static void print_table(const struct figure *figures, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        (void)printf("%-40s %12.4f %s\n", figures[i].label, figures[i].value, figures[i].unit);
    }
}

static json_t *figures_to_json(const struct figure *figures, size_t count)
{
    json_t *root = json_object();

    for (size_t i = 0; i < count; i++) {
        (void)json_object_set_new(root, figures[i].key, json_real(figures[i].value));
    }
    return root;
}

static bool print(const struct arguments *arguments, const struct skid_world *world)
{
    const struct skid_plant *plant = &world->plant;
    const struct planar_pose pose = skid_plant_pose(plant);
    const struct skid_ledger *l = &plant->state.ledger;
    const struct figure figures[] = {
        {"x_m", "x", "m", pose.x},
        {"y_m", "y", "m", pose.y},
        {"heading_deg", "heading", "°", pose.heading * 180 / M_PI},
        {"speed_m_s", "speed", "m/s", plant->state.forward},
        {"turn_rate_rad_s", "turn rate", "rad/s", plant->state.turn_rate},
        {"tipped", "tipped over: 1", "", plant->tipped},
        {"battery_j", "out of the battery's cells", "J", l->battery},
        {"supply_j", "lost in the battery's resistance", "J", l->supply},
        {"electronics_j", "electronics", "J", l->electronics},
        {"bridge_j", "burnt by the bridges", "J", l->bridge},
        {"copper_j", "windings", "J", l->copper},
        {"gear_j", "gears and bearings", "J", l->gear},
        {"slip_along_j", "slip along the wheels", "J", l->slip_along},
        {"slip_across_j", "slip across the wheels", "J", l->slip_across},
        {"rolling_j", "rolling", "J", l->rolling},
        {"caster_j", "caster", "J", l->caster},
        {"impact_j", "lost by tipping over", "J", l->impact},
        {"kinetic_j", "kinetic energy", "J", skid_plant_kinetic_energy(plant)},
        {"potential_j", "potential energy", "J", skid_plant_potential_energy(plant)},
        {"residual_j", "missed by the ledger", "J", skid_plant_residual(plant, 0)},
    };
    const size_t count = sizeof figures / sizeof figures[0];

    if (arguments->common.json != NULL && !output_json(NULL, arguments->common.json, figures_to_json(figures, count))) {
        return false;
    }
    if (arguments->common.json == NULL || strcmp(arguments->common.json, "-") != 0) {
        print_table(figures, count);
    }
    return output_commit();
}

static jp_q31 q31(double duty)
{
    return (jp_q31)fmin(duty * 2147483648.0, INT32_MAX);
}

static bool run(const struct arguments *arguments)
{
    struct skid_steer_model model;

    if (!skid_robot_load(arguments->common.robot, &model)) {
        return false;
    }
    const struct skid_slope slope = skid_slope_towards(arguments->slope_deg, 0);
    const struct skid_ground ground = skid_ground_slope(&slope);
    const struct planar_pose pose = {0, 0, arguments->heading_deg * M_PI / 180};
    struct skid_world world;

    skid_world_init(&world, &model, &ground, &pose, 1);
    world.actuation = (struct jp_actuation){q31(arguments->left), q31(arguments->right), 1};
    while ((double)world.tick * skid_world_tick_seconds(&world) < arguments->seconds) {
        skid_world_step(&world);
    }
    return print(arguments, &world);
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        OPTION_JSON,
        {"left", LEFT, "DUTY", 0, "of the left motor, -1 to 1 of the bus voltage (0: shorted)", 0},
        {"right", RIGHT, "DUTY", 0, "of the right motor", 0},
        {"seconds", SECONDS, "T", 0, "how long (10)", 0},
        {"slope", SLOPE, "DEGREES", 0, "of the ground, which rises along x (0)", 0},
        {"heading", HEADING, "DEGREES", 0, "at the start, from x to the left (0)", 0},
        {0}};
    static const struct argp parser = {options,
                                       parse_option,
                                       "ROBOT",
                                       "Drives a simulated skid-steered or differential-drive robot with constant "
                                       "duties and says where its energy went.",
                                       NULL,
                                       NULL,
                                       NULL};
    struct arguments arguments = {.seconds = 10};

    command_line_parse(&parser, argc, argv, &arguments);
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
