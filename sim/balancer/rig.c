#include "sim/balancer/rig.h"

#include <stdio.h>
#include <string.h>

#include "sim/base/error.h"

/** The hand holds long enough for the estimator to settle. */
#define HOLD_TICKS 10

static void list_names(char *text, size_t size)
{
    size_t length = 0;

    text[0] = '\0';
    for (size_t i = 0; i < robot_count && length < size; i++) {
        length += (size_t)snprintf(text + length, size - length, "%s%s", i == 0 ? "" : ", ", robots[i].name);
    }
}

const struct robot_entry *rig_find_robot(const char *name)
{
    char names[256];

    for (size_t i = 0; i < robot_count; i++) {
        if (strcmp(robots[i].name, name) == 0) {
            return &robots[i];
        }
    }
    list_names(names, sizeof names);
    error_line("%s: no gains for this robot; run make gains ROBOT=%s, or choose one of: %s", name, name, names);
    return NULL;
}

const struct jp_energy_model *rig_energy_model(const struct robot_entry *entry, enum energy_kind kind)
{
    const struct jp_energy_model *model = kind == ENERGY_BATTERY ? entry->energy_battery : entry->energy;

    if (model == NULL) {
        error_line("%s: no model of the battery's energy; run make identify ROBOT=%s", entry->name, entry->name);
    }
    return model;
}

bool rig_init(struct rig *rig, const struct robot_entry *entry, const struct robot_file *file, uint64_t seed)
{
    const char *field = "";

    world_init(&rig->world, file, seed);
    plant_hold(&rig->world.plant, 0);
    rig->hal = jp_hal_sim(&rig->world);
    rig->written = JP_OK;
    if (jp_robot_init(&rig->robot, entry->config, &field) != JP_OK) {
        error_line("%s: %s is out of range; run make gains ROBOT=%s", entry->name, field, entry->name);
        return false;
    }
    return true;
}

void rig_tick(struct rig *rig)
{
    jp_hal_tick(&rig->hal, &rig->robot, &rig->written);
    world_step(&rig->world);
}

void rig_release(struct rig *rig, double pitch_rad)
{
    plant_hold(&rig->world.plant, pitch_rad);
    for (int i = 0; i < HOLD_TICKS; i++) {
        rig_tick(rig);
    }
    (void)jp_robot_enable(&rig->robot);
    plant_release(&rig->world.plant);
    rig_tick(rig);
}
