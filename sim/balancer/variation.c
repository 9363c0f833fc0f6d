#include "sim/balancer/variation.h"

#include <stdlib.h>
#include <string.h>

#include "sim/base/error.h"

#define FACTOR_MIN 0.1
#define FACTOR_MAX 10.0

const struct variation_member variation_members[] = {
    {"friction", "ground_friction", offsetof(struct variation, ground_friction), 0.6, 1.6, FACTOR_MIN, FACTOR_MAX},
    {"payload", "payload_kg", offsetof(struct variation, payload_kg), 0, 0, -10, 100},
    {"resistance", "motor_resistance", offsetof(struct variation, motor_resistance), 0.92, 1.12, FACTOR_MIN,
     FACTOR_MAX},
    {"motor-friction", "motor_friction", offsetof(struct variation, motor_friction), 0.8, 1.25, FACTOR_MIN, FACTOR_MAX},
    {"capacity", "capacity", offsetof(struct variation, capacity), 0.7, 1, FACTOR_MIN, FACTOR_MAX},
};

const size_t variation_member_count = sizeof variation_members / sizeof variation_members[0];

const struct variation variation_none = {1, 0, 1, 1, 1};

static void set(struct variation *variation, const struct variation_member *member, double value)
{
    memcpy((char *)variation + member->offset, &value, sizeof value);
}

double variation_value(const struct variation *variation, const struct variation_member *member)
{
    double value;

    memcpy(&value, (const char *)variation + member->offset, sizeof value);
    return value;
}

void variation_draw(struct random *random, const struct robot_file *file, struct variation *variation)
{
    for (size_t i = 0; i < variation_member_count; i++) {
        const struct variation_member *member = &variation_members[i];
        const bool is_payload = member->offset == offsetof(struct variation, payload_kg);
        const double low = is_payload ? file->limits.payload_kg[0] : member->low;
        const double high = is_payload ? file->limits.payload_kg[1] : member->high;

        set(variation, member, random_uniform(random, low, high));
    }
}

void variation_apply(const struct variation *variation, const struct robot_file *nominal, struct robot_file *varied)
{
    *varied = *nominal;
    varied->ground.friction *= variation->ground_friction;
    varied->body.mass_kg += variation->payload_kg;
    varied->motor.resistance_ohm *= variation->motor_resistance;
    varied->motor.friction *= variation->motor_friction;
    varied->supply.capacity_wh *= variation->capacity;
}

static const struct variation_member *find(const char *name, size_t length)
{
    for (size_t i = 0; i < variation_member_count; i++) {
        if (strlen(variation_members[i].name) == length && strncmp(variation_members[i].name, name, length) == 0) {
            return &variation_members[i];
        }
    }
    return NULL;
}

/** One "name=value" whose name is not among the `taken` bits; returns what follows it, or NULL after one line on
 * stderr. */
static const char *parse_member(const char *option, const char *text, unsigned *taken, struct variation *variation)
{
    const size_t length = strcspn(text, "=,");
    const struct variation_member *member = find(text, length);

    if (member == NULL || text[length] != '=') {
        error_line("%s: %.*s: must be NAME=NUMBER with the name friction, payload, resistance, motor-friction or "
                   "capacity",
                   option, (int)strcspn(text, ","), text);
        return NULL;
    }

    const char *number = text + length + 1;
    char *end;
    const double value = strtod(number, &end);

    if (end == number || (*end != ',' && *end != '\0') || !(value >= member->min && value <= member->max)) {
        error_line("%s: %s: must be a number from %g to %g", option, member->name, member->min, member->max);
        return NULL;
    }
    if ((*taken >> (member - variation_members) & 1) != 0) {
        error_line("%s: %s: is given twice; leave one of them out", option, member->name);
        return NULL;
    }
    *taken |= 1U << (member - variation_members);
    set(variation, member, value);
    return end;
}

bool variation_parse(const char *option, const char *text, struct variation *variation)
{
    unsigned taken = 0;
    const char *rest = parse_member(option, text, &taken, variation);

    while (rest != NULL && *rest == ',') {
        rest = parse_member(option, rest + 1, &taken, variation);
    }
    return rest != NULL;
}
