#include <joulepath/lattice_way.h>

#include <string.h>

#include "src/base/block.h"
#include "src/base/compiler.h"
#include "src/map/unit_step.h"

enum {
    WORD_BITS = 32,
    MARK_BITS = 2,
    MARKS_A_WORD = WORD_BITS / MARK_BITS,
    MARK_MASK = 3,
    PLANES = 3,
    NO_MARK = 0,
    FIRST_MARK = 1,
    LAST_MARK = 3,
    SKIPPED_WORDS = 8 /* empty ones of the front, of a look */
};

static const struct jp_way_words no_words = {UINT32_MAX, 0};

static uint32_t front_words(const struct jp_terrain_config *config)
{
    return ((uint32_t)config->width * config->height + WORD_BITS - 1U) / WORD_BITS;
}

size_t jp_lattice_way_size(const struct jp_terrain_config *config)
{
    return jp_terrain_size(config) == 0U ? 0U : PLANES * sizeof(uint32_t) * front_words(config);
}

static uint32_t index_of(const struct jp_lattice_way *way, const struct jp_way_cell *cell)
{
    return (uint32_t)cell->y * way->terrain->config.width + (uint32_t)cell->x;
}

static unsigned mark_at(const struct jp_lattice_way *way, uint32_t index)
{
    return (unsigned)(way->marks[index / MARKS_A_WORD] >> (index % MARKS_A_WORD * MARK_BITS)) & MARK_MASK;
}

static unsigned mark_after(unsigned mark)
{
    return mark == LAST_MARK ? FIRST_MARK : mark + 1U;
}

/** True when a cell may be a step nearer to the goal than its neighbour, by their marks. */
static bool is_before(unsigned mark, unsigned mark_of_neighbour)
{
    return mark != NO_MARK && mark_after(mark) == mark_of_neighbour;
}

/** Of a cell that has none yet, which so belongs to the next front. */
static void set_mark(struct jp_lattice_way *way, uint32_t index, unsigned mark)
{
    const uint32_t word = index / WORD_BITS;

    way->marks[index / MARKS_A_WORD] |= (uint32_t)mark << (index % MARKS_A_WORD * MARK_BITS);
    way->front[word] |= UINT32_C(1) << (index % WORD_BITS);
    way->next.first = word < way->next.first ? word : way->next.first;
    way->next.last = word > way->next.last ? word : way->next.last;
}

/** The cells that are a step farther. False: there are none. */
static bool take_next_front(struct jp_lattice_way *way)
{
    const bool has_next = way->next.first <= way->next.last;

    way->present = way->next;
    way->next = no_words;
    return has_next;
}

static unsigned opposite_of(unsigned direction)
{
    return (direction + JP_MOVE_DIRECTIONS / 2U) % JP_MOVE_DIRECTIONS;
}

/** True when a step sweeps the same cells as the step back from its end. */
static bool sweeps_alike(const struct jp_lattice *lattice, const struct jp_primitive *step,
                         const struct jp_primitive *back)
{
    bool is_alike = step->span_count == back->span_count;

    for (unsigned i = 0; is_alike && i < step->span_count; i++) {
        const struct jp_span *there = &lattice->spans[step->first_span + i];
        const struct jp_span *here = &lattice->spans[back->first_span + i];

        is_alike = there->y == here->y + step->dy && there->first == here->first + step->dx &&
                   there->last == here->last + step->dx;
    }
    return is_alike;
}

static void take_steps(struct jp_lattice_way *way)
{
    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        way->step[direction] = jp_unit_step(way->lattice, direction);
    }
    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        const struct jp_primitive *step = way->step[direction];
        const struct jp_primitive *back = way->step[opposite_of(direction)];

        if (back != NULL && step != NULL && sweeps_alike(way->lattice, step, back)) {
            way->alike |= (uint16_t)(1U << direction);
        }
    }
}

static bool contains(const struct jp_terrain *terrain, const struct jp_way_cell *cell)
{
    return jp_terrain_contains(terrain, cell->x, cell->y);
}

enum jp_status jp_lattice_way_start(struct jp_lattice_way *way, const struct jp_lattice *lattice,
                                    const struct jp_terrain *terrain, const struct jp_way_cell *start,
                                    const struct jp_way_cell *goal, void *block, size_t size)
{
    if (way == NULL || lattice == NULL || terrain == NULL || start == NULL || goal == NULL || block == NULL) {
        return JP_ERR_ARGUMENT;
    }
    if (size < jp_lattice_way_size(&terrain->config)) {
        return JP_ERR_MEMORY;
    }
    if (!jp_block_is_aligned(block)) {
        return JP_ERR_ALIGNMENT;
    }
    if (!contains(terrain, start) || !contains(terrain, goal)) {
        return JP_ERR_OUTSIDE;
    }
    *way = (struct jp_lattice_way){.lattice = lattice,
                                   .terrain = terrain,
                                   .front = block,
                                   .marks = (uint32_t *)block + front_words(&terrain->config),
                                   .start = *start,
                                   .goal = *goal,
                                   .next = no_words,
                                   .mark = FIRST_MARK};
    (void)memset(block, 0, jp_lattice_way_size(&terrain->config));
    take_steps(way);
    set_mark(way, index_of(way, goal), FIRST_MARK);
    (void)take_next_front(way);
    way->answer = index_of(way, start) == index_of(way, goal) ? JP_WAY_FOUND : JP_WAY_WORKING;
    return JP_OK;
}

static bool is_too_steep(const struct jp_lattice_way *way, const struct jp_primitive *step,
                         const struct jp_way_cell *from)
{
    return way->terrain->config.has_elevation &&
           jp_lattice_energy(way->lattice, JP_COST_PHYSICAL, way->terrain, step, from->x, from->y) == JP_COST_MAX;
}

static bool can_step(const struct jp_lattice_way *way, unsigned direction, const struct jp_way_cell *from)
{
    const struct jp_primitive *step = way->step[direction];

    return step != NULL && jp_lattice_is_clear(way->lattice, way->terrain, step, from->x, from->y) &&
           !is_too_steep(way, step, from);
}

static struct jp_way_cell neighbour(const struct jp_way_cell *cell, unsigned direction)
{
    const struct jp_cell_offset *offset = &jp_move_offsets[direction];

    return (struct jp_way_cell){(int16_t)(cell->x + offset->dx), (int16_t)(cell->y + offset->dy)};
}

/** True when the robot can drive from a cell to its neighbour, and back: so that neighbours are at most a step apart,
 *  which is what their marks are told apart by. */
static bool is_passable(const struct jp_lattice_way *way, unsigned direction, const struct jp_way_cell *from,
                        const struct jp_way_cell *to)
{
    return can_step(way, direction, from) &&
           ((((uint32_t)way->alike >> direction) & 1U) != 0U || can_step(way, opposite_of(direction), to));
}

/** To those neighbours of a cell that have no mark. Returns how many were looked at. */
static unsigned spread(struct jp_lattice_way *way, const struct jp_way_cell *cell)
{
    const unsigned mark = mark_after(way->mark);
    unsigned looks = 0;

    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        const struct jp_way_cell to = neighbour(cell, direction);

        if (!contains(way->terrain, &to) || mark_at(way, index_of(way, &to)) != NO_MARK) {
            continue;
        }
        looks++;
        if (is_passable(way, direction, cell, &to)) {
            set_mark(way, index_of(way, &to), mark);
        }
    }
    return looks;
}

/** Takes a cell of the present front out of its first word. False: there is none in it. */
static bool take_cell(struct jp_lattice_way *way, struct jp_way_cell *cell)
{
    const uint32_t word = way->present.first;
    const uint32_t width = way->terrain->config.width;

    for (uint32_t bits = way->front[word]; bits != 0U; bits &= bits - 1U) {
        const uint32_t index = word * WORD_BITS + JP_TRAILING_ZEROS(bits);

        if (mark_at(way, index) == way->mark) {
            way->front[word] &= ~(bits & (~bits + 1U));
            cell->x = (int16_t)(uint16_t)(index % width);
            cell->y = (int16_t)(uint16_t)(index / width);
            return true;
        }
    }
    return false;
}

/** To the next word of the front that is not empty, or some way towards it; at its end to the next front. */
static void advance(struct jp_lattice_way *way)
{
    struct jp_way_words *present = &way->present;
    unsigned skipped = 0;

    do {
        present->first++;
        skipped++;
    } while (skipped < SKIPPED_WORDS && present->first <= present->last && way->front[present->first] == 0U);
    if (present->first > present->last) {
        way->mark = (uint8_t)mark_after(way->mark);
        way->answer = take_next_front(way) ? JP_WAY_WORKING : JP_WAY_NONE;
    }
}

enum jp_way_answer jp_lattice_way_work(struct jp_lattice_way *way, unsigned looks)
{
    unsigned spent = 0;

    while (spent < looks && way->answer == JP_WAY_WORKING) {
        struct jp_way_cell cell;

        spent++;
        if (!take_cell(way, &cell)) {
            advance(way);
        } else {
            spent += spread(way, &cell);
            way->answer = mark_at(way, index_of(way, &way->start)) == NO_MARK ? JP_WAY_WORKING : JP_WAY_FOUND;
        }
    }
    return way->answer;
}

bool jp_lattice_way_next(const struct jp_lattice_way *way, struct jp_way_cell *cell)
{
    const unsigned mark = mark_at(way, index_of(way, cell));

    for (unsigned direction = 0; direction < JP_MOVE_DIRECTIONS; direction++) {
        const struct jp_way_cell next = neighbour(cell, direction);

        if (contains(way->terrain, &next) && is_before(mark_at(way, index_of(way, &next)), mark) &&
            is_passable(way, direction, cell, &next)) {
            *cell = next;
            return true;
        }
    }
    return false;
}
