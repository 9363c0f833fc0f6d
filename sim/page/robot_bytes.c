/* Writes the constants of robot files as C for the page (page_robots.h): robot_bytes ROBOT.cfg… The page's processor
 * lays them out as this one does, of which the compiler convinces itself. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim/balancer/robot_file.h"
#include "sim/base/error.h"
#include "sim/four_wheel/four_wheel_file.h"
#include "sim/lattice/lattice_robot.h"
#include "sim/skid_steer/skid_steer_model.h"

enum kind { BALANCER, SKID_STEER, FOUR_WHEEL, KINDS };

static const struct {
    const char *type;
    size_t size;
    const char *list;
} kinds[KINDS] = {
    [BALANCER] = {"robot_file", sizeof(struct robot_file), "page_balancer"},
    [SKID_STEER] = {"skid_steer_model", sizeof(struct skid_steer_model), "page_skid_robot"},
    [FOUR_WHEEL] = {"four_wheel_file", sizeof(struct four_wheel_file), "page_patrol_robot"},
};

static union {
    unsigned char bytes[1];
    struct robot_file balancer;
    struct skid_steer_model skid_steer;
    struct four_wheel_file four_wheel;
} robot;

static bool load(const char *path, enum kind *kind)
{
    char type[CONFIG_NAME_SIZE];

    memset(&robot, 0, sizeof robot);
    if (!config_fields_type(path, type)) {
        return false;
    }
    if (strcmp(type, CONFIG_BALANCER) == 0) {
        *kind = BALANCER;
        return robot_file_load(path, &robot.balancer);
    }
    if (strcmp(type, four_wheel_kind.type) == 0) {
        *kind = FOUR_WHEEL;
        return four_wheel_file_load(path, &robot.four_wheel);
    }
    *kind = SKID_STEER;
    return skid_robot_load(path, &robot.skid_steer);
}

static void write_bytes(enum kind kind, int number)
{
    const unsigned char *bytes = (const unsigned char *)&robot;

    (void)printf("_Static_assert(sizeof(struct %s) == %zu, \"laid out as where this was written\");\n"
                 "static const union {\n    unsigned char bytes[%zu];\n    struct %s robot;\n} robot_%d = {{",
                 kinds[kind].type, kinds[kind].size, kinds[kind].size, kinds[kind].type, number);
    for (size_t i = 0; i < kinds[kind].size; i++) {
        (void)printf("%s%u,", i % 32 == 0 ? "\n" : "", bytes[i]);
    }
    (void)printf("}};\n");
}

static void write_list(enum kind kind, const enum kind *of, int count)
{
    int members = 0;

    (void)printf("const struct %s *const %ss[] = {", kinds[kind].type, kinds[kind].list);
    for (int i = 0; i < count; i++) {
        if (of[i] == kind) {
            (void)printf("&robot_%d.robot, ", i);
            members++;
        }
    }
    (void)printf("NULL};\nconst size_t %s_count = %d;\n", kinds[kind].list, members);
}

/* False after an error. */
static bool write_grades(enum kind kind, const enum kind *of, char **paths, int count)
{
    static struct lattice_robot described;

    (void)printf("const double %s_grades[] = {", kinds[kind].list);
    for (int i = 0; i < count; i++) {
        if (of[i] == kind) {
            if (!lattice_robot_load(paths[i], &described)) {
                return false;
            }
            (void)printf("%a, ", described.grade_max);
        }
    }
    (void)printf("0};\n");
    return true;
}

#define ROBOTS_MAX 32

int main(int argc, char **argv)
{
    enum kind of[ROBOTS_MAX];
    const int count = argc - 1;

    if (count < 1 || count > ROBOTS_MAX) {
        error_line("robot_bytes: give 1 to %d robot files", ROBOTS_MAX);
        return ERROR_EXIT;
    }
    (void)printf("#include \"sim/page/page_robots.h\"\n\n");
    for (int i = 0; i < count; i++) {
        if (!load(argv[i + 1], &of[i])) {
            return ERROR_EXIT;
        }
        write_bytes(of[i], i);
    }
    for (enum kind kind = 0; kind < KINDS; kind++) {
        write_list(kind, of, count);
    }
    return write_grades(BALANCER, of, &argv[1], count) && write_grades(SKID_STEER, of, &argv[1], count) ? EXIT_SUCCESS
                                                                                                        : ERROR_EXIT;
}
