#include "tests/support/scene.h"

enum {
    CELLS = SCENE_SIDE * SCENE_SIDE,
    ROW_WORDS = (SCENE_SIDE + 31) / 32,
    CELLS_PER_METRE = 5,
    PERCENT = CELLS / 100,
    DIRECTIONS = 16
};

/* ---- Random numbers: SplitMix with 32 bits ---- */

static uint32_t mix(uint32_t z)
{
    z = (z ^ (z >> 16)) * UINT32_C(0x85ebca6b);
    z = (z ^ (z >> 13)) * UINT32_C(0xc2b2ae35);
    return z ^ (z >> 16);
}

static uint32_t draw(uint32_t *random)
{
    *random += UINT32_C(0x9e3779b9);
    return mix(*random);
}

/* Uniform in low…high. */
static int32_t draw_between(uint32_t *random, int32_t low, int32_t high)
{
    const uint32_t range = (uint32_t)(high - low) + 1;
    return low + (int32_t)(((uint64_t)draw(random) * range) >> 32);
}

/* Unit vectors round the circle, Q8. */
struct direction {
    int16_t x;
    int16_t y;
};
static const struct direction directions[DIRECTIONS] = {
    {256, 0},  {237, 98},   {181, 181},   {98, 237},   {0, 256},  {-98, 237}, {-181, 181}, {-237, 98},
    {-256, 0}, {-237, -98}, {-181, -181}, {-98, -237}, {0, -256}, {98, -237}, {181, -181}, {237, -98},
};

/* ---- Hills: gradient noise in four octaves ---- */

#define ONE_Q16 65536

struct octave {
    int32_t side;      /* of the noise's grid, cells; a hill is about twice as wide */
    int32_t amplitude; /* unit of jp_elevation */
};
static const struct octave octaves[] = {{103, 3900}, {57, 1250}, {31, 340}, {15, 90}};
enum { OCTAVES = sizeof octaves / sizeof octaves[0] };

/* 6t⁵ − 15t⁴ + 10t³: joins the squares of the grid without an edge. Q16. */
static int32_t fade(int32_t t)
{
    const int64_t inner = (((6 * (int64_t)t - 15 * ONE_Q16) * t) >> 16) + 10 * ONE_Q16;
    const int64_t square = ((int64_t)t * t) >> 16;
    return (int32_t)((((square * t) >> 16) * inner) >> 16);
}

static int32_t blend(int32_t a, int32_t b, int32_t share)
{
    return a + (int32_t)(((int64_t)(b - a) * share) >> 16);
}

/* Height above the slope at a point of the grid, at (dx, dy) from it. Q16. */
static int32_t slope_height(uint32_t key, int32_t column, int32_t row, int32_t dx, int32_t dy)
{
    const uint32_t hash = mix(key ^ mix((uint32_t)column * UINT32_C(0x9e3779b9) + (uint32_t)row));
    const struct direction *gradient = &directions[hash % DIRECTIONS];
    return (int32_t)(((int64_t)gradient->x * dx + (int64_t)gradient->y * dy) >> 8);
}

/* Gradient noise, Q16, about ±0.7. */
static int32_t noise(uint32_t key, int32_t side, int32_t x, int32_t y)
{
    const int32_t column = x / side;
    const int32_t row = y / side;
    const int32_t dx = x % side * ONE_Q16 / side;
    const int32_t dy = y % side * ONE_Q16 / side;
    const int32_t share = fade(dx);
    const int32_t south =
        blend(slope_height(key, column, row, dx, dy), slope_height(key, column + 1, row, dx - ONE_Q16, dy), share);
    const int32_t north = blend(slope_height(key, column, row + 1, dx, dy - ONE_Q16),
                                slope_height(key, column + 1, row + 1, dx - ONE_Q16, dy - ONE_Q16), share);
    return blend(south, north, fade(dy));
}

struct hills {
    uint32_t key[OCTAVES];
    int32_t shift_x[OCTAVES]; /* of the noise's grid, cells */
    int32_t shift_y[OCTAVES];
    int32_t ruggedness; /* Q8 */
};

static jp_elevation hill_height(const struct hills *hills, int32_t x, int32_t y)
{
    int64_t sum = 0;
    for (unsigned i = 0; i < OCTAVES; i++) {
        const int32_t height = noise(hills->key[i], octaves[i].side, x + hills->shift_x[i], y + hills->shift_y[i]);
        sum += (int64_t)height * octaves[i].amplitude;
    }
    return (jp_elevation)((sum * hills->ruggedness) >> 24);
}

static void raise_hills(struct jp_terrain *terrain, uint32_t *random)
{
    struct hills hills = {.ruggedness = draw_between(random, 185, 265)};
    for (unsigned i = 0; i < OCTAVES; i++) {
        hills.key[i] = draw(random);
        hills.shift_x[i] = draw_between(random, 0, octaves[i].side - 1);
        hills.shift_y[i] = draw_between(random, 0, octaves[i].side - 1);
    }
    for (int32_t i = 0; i < CELLS; i++) {
        const int32_t x = i % SCENE_SIDE;
        const int32_t y = i / SCENE_SIDE;
        (void)jp_terrain_set_elevation(terrain, x, y, hill_height(&hills, x, y));
    }
}

/* ---- Steep ground ---- */

/* Unit steps of the lattice to one side, and the rise of each at 15°, units of jp_elevation. */
struct step {
    int8_t dx;
    int8_t dy;
    int16_t rise_max;
};
static const struct step steps[] = {{1, 0, 54}, {2, 1, 122},  {1, 1, 77},  {1, 2, 122},
                                    {0, 1, 54}, {-1, 2, 122}, {-1, 1, 77}, {-2, 1, 122}};
enum { STEPS = sizeof steps / sizeof steps[0] };

static bool is_step_steep(const struct jp_terrain *terrain, int32_t x, int32_t y, int32_t dx, int32_t dy,
                          int32_t rise_max)
{
    if (!jp_terrain_contains(terrain, x + dx, y + dy)) {
        return false;
    }
    const int32_t rise = jp_terrain_elevation(terrain, x + dx, y + dy) - jp_terrain_elevation(terrain, x, y);
    return rise > rise_max || rise < -rise_max;
}

static bool is_steep(const struct jp_terrain *terrain, int32_t x, int32_t y)
{
    for (unsigned i = 0; i < STEPS; i++) {
        const struct step *s = &steps[i];
        if (is_step_steep(terrain, x, y, s->dx, s->dy, s->rise_max) ||
            is_step_steep(terrain, x, y, -s->dx, -s->dy, s->rise_max)) {
            return true;
        }
    }
    return false;
}

static void occupy_steep_ground(struct jp_terrain *terrain)
{
    for (int32_t i = 0; i < CELLS; i++) {
        const int32_t x = i % SCENE_SIDE;
        const int32_t y = i / SCENE_SIDE;
        (void)jp_terrain_set_cell(terrain, x, y, is_steep(terrain, x, y) ? JP_CELL_OCCUPIED : JP_CELL_FREE);
    }
}

static int32_t count_blocked(const struct jp_terrain *terrain)
{
    int32_t count = 0;
    for (int32_t i = 0; i < CELLS; i++) {
        count += jp_terrain_cell(terrain, i % SCENE_SIDE, i / SCENE_SIDE) != JP_CELL_FREE;
    }
    return count;
}

/* ---- Task ---- */

enum {
    CLEARING = 2 * CELLS_PER_METRE, /* radius of the free ground round start and goal */
    BORDER = CLEARING + 1,
    DISTANCE_MIN = 40 * CELLS_PER_METRE,
    DISTANCE_MAX = 65 * CELLS_PER_METRE,
    OFF_CENTRE_MAX = 9 * CELLS_PER_METRE, /* of the middle between start and goal */
    TASK_DRAWS = 2000
};

static bool is_within(int32_t dx, int32_t dy, int32_t radius)
{
    return dx * dx + dy * dy <= radius * radius;
}

static struct scene_pose draw_pose(uint32_t *random)
{
    return (struct scene_pose){.x = (uint16_t)draw_between(random, BORDER, SCENE_SIDE - 1 - BORDER),
                               .y = (uint16_t)draw_between(random, BORDER, SCENE_SIDE - 1 - BORDER),
                               .heading = (uint8_t)draw_between(random, 0, SCENE_HEADINGS - 1)};
}

static bool are_opposite(const struct scene_pose *a, const struct scene_pose *b)
{
    const int32_t dx = a->x - b->x;
    const int32_t dy = a->y - b->y;
    return is_within(dx, dy, DISTANCE_MAX) && !is_within(dx, dy, DISTANCE_MIN) &&
           is_within((a->x + b->x - SCENE_SIDE) / 2, (a->y + b->y - SCENE_SIDE) / 2, OFF_CENTRE_MAX);
}

static bool is_clearing(const struct jp_terrain *terrain, const struct scene_pose *pose)
{
    for (int32_t dy = -CLEARING; dy <= CLEARING; dy++) {
        for (int32_t dx = -CLEARING; dx <= CLEARING; dx++) {
            if (is_within(dx, dy, CLEARING) && jp_terrain_cell(terrain, pose->x + dx, pose->y + dy) != JP_CELL_FREE) {
                return false;
            }
        }
    }
    return true;
}

static bool draw_task(const struct jp_terrain *terrain, uint32_t *random, struct scene_task *task)
{
    for (int i = 0; i < TASK_DRAWS; i++) {
        task->start = draw_pose(random);
        task->goal = draw_pose(random);
        if (are_opposite(&task->start, &task->goal) && is_clearing(terrain, &task->start) &&
            is_clearing(terrain, &task->goal)) {
            return true;
        }
    }
    return false;
}

/* ---- Obstacles ---- */

/* Lengths of shapes are in 1/16 cell. */
enum {
    UNIT = 16,
    METRE = CELLS_PER_METRE * UNIT,
    WALLS_MAX = 5,
    WALL_HALF_WIDTH = METRE / 5,
    GAP_HALF_WIDTH_MIN = METRE, /* a wall's gap is wider than the way that must be there */
    PATCHES_MAX = 9,
    OBSTACLES_MIN = 9 * PERCENT, /* cells, with the steep ones */
    OBSTACLES_MAX = 14 * PERCENT,
    SHARE_MIN = 8 * PERCENT, /* cells of a valid scene */
    SHARE_MAX = 15 * PERCENT
};

/* An ellipse or a rectangle. */
struct shape {
    int32_t x; /* centre */
    int32_t y;
    int32_t half_length;
    int32_t half_width;
    unsigned direction;
    bool is_round;
};

static bool is_inside(const struct shape *shape, int32_t dx, int32_t dy)
{
    const struct direction *d = &directions[shape->direction];
    const int32_t along = (dx * d->x + dy * d->y) / 256;
    const int32_t across = (dy * d->x - dx * d->y) / 256;
    if (shape->is_round) {
        const int64_t a = (int64_t)along * shape->half_width;
        const int64_t b = (int64_t)across * shape->half_length;
        const int64_t limit = (int64_t)shape->half_length * shape->half_width;
        return a * a + b * b <= limit * limit;
    }
    return along <= shape->half_length && along >= -shape->half_length && across <= shape->half_width &&
           across >= -shape->half_width;
}

static bool is_in_clearing(const struct scene_task *task, int32_t x, int32_t y)
{
    return is_within(x - task->start.x, y - task->start.y, CLEARING) ||
           is_within(x - task->goal.x, y - task->goal.y, CLEARING);
}

/* Gives the cells of a shape a value, except round start and goal; returns how many of them were free. */
static int32_t paint(struct jp_terrain *terrain, const struct scene_task *task, const struct shape *shape,
                     enum jp_cell cell)
{
    const int32_t reach = (shape->half_length + shape->half_width) / UNIT + 1;
    const int32_t centre_x = shape->x / UNIT;
    const int32_t centre_y = shape->y / UNIT;
    int32_t count = 0;
    for (int32_t y = centre_y - reach; y <= centre_y + reach; y++) {
        for (int32_t x = centre_x - reach; x <= centre_x + reach; x++) {
            if (jp_terrain_contains(terrain, x, y) && !is_in_clearing(task, x, y) &&
                is_inside(shape, x * UNIT + UNIT / 2 - shape->x, y * UNIT + UNIT / 2 - shape->y)) {
                count += jp_terrain_cell(terrain, x, y) == JP_CELL_FREE;
                (void)jp_terrain_set_cell(terrain, x, y, cell);
            }
        }
    }
    return count;
}

static struct shape draw_shape(uint32_t *random, int32_t half_min, int32_t half_max)
{
    return (struct shape){.x = draw_between(random, 0, SCENE_SIDE * UNIT - 1),
                          .y = draw_between(random, 0, SCENE_SIDE * UNIT - 1),
                          .half_length = draw_between(random, half_min, half_max),
                          .half_width = draw_between(random, half_min, half_max),
                          .direction = (unsigned)draw_between(random, 0, DIRECTIONS - 1),
                          .is_round = draw_between(random, 0, 2) != 0};
}

/* Two pieces in a line with a gap of 2…3 m between them. */
static int32_t build_wall(struct jp_terrain *terrain, const struct scene_task *task, uint32_t *random)
{
    struct shape piece = draw_shape(random, 2 * METRE, 5 * METRE);
    const struct direction *d = &directions[piece.direction];
    const int32_t gap = draw_between(random, GAP_HALF_WIDTH_MIN, GAP_HALF_WIDTH_MIN * 3 / 2);
    const int32_t x = piece.x;
    const int32_t y = piece.y;
    int32_t count = 0;
    piece.is_round = false;
    piece.half_width = WALL_HALF_WIDTH;
    for (int32_t side = -1; side <= 1; side += 2) {
        const int32_t middle = side * (gap + piece.half_length);
        piece.x = x + middle * d->x / 256;
        piece.y = y + middle * d->y / 256;
        count += paint(terrain, task, &piece, JP_CELL_OCCUPIED);
    }
    return count;
}

static void place_obstacles(struct jp_terrain *terrain, const struct scene_task *task, uint32_t *random)
{
    const int32_t wanted = draw_between(random, OBSTACLES_MIN, OBSTACLES_MAX);
    int32_t blocked = count_blocked(terrain);
    for (int32_t walls = draw_between(random, 0, WALLS_MAX); walls > 0; walls--) {
        blocked += build_wall(terrain, task, random);
    }
    while (blocked < wanted) {
        const struct shape rock = draw_shape(random, METRE / 4, METRE * 3 / 2);
        blocked += paint(terrain, task, &rock, JP_CELL_OCCUPIED);
    }
}

/* One scene in three has patches that nobody has seen. */
static void place_patches(struct jp_terrain *terrain, const struct scene_task *task, uint32_t random, enum jp_cell cell)
{
    if (draw_between(&random, 0, 2) != 0) {
        return;
    }
    for (int32_t patches = draw_between(&random, 2, PATCHES_MAX); patches > 0; patches--) {
        const struct shape patch = draw_shape(&random, METRE / 3, METRE);
        (void)paint(terrain, task, &patch, cell);
    }
}

/* ---- Way from start to goal ---- */

/* A disc with a diameter of 1.4 m. */
static const struct jp_span disc[] = {{-3, -1, 1}, {-2, -2, 2}, {-1, -3, 3}, {0, -3, 3},
                                      {1, -3, 3},  {2, -2, 2},  {3, -1, 1}};

typedef uint32_t bit_plane[SCENE_SIDE][ROW_WORDS];

static bool has_bit(bit_plane plane, int32_t x, int32_t y)
{
    return x >= 0 && x < SCENE_SIDE && y >= 0 && y < SCENE_SIDE && (plane[y][x / 32] >> (x % 32) & 1) != 0;
}

static void set_bit(bit_plane plane, int32_t x, int32_t y)
{
    plane[y][x / 32] |= UINT32_C(1) << (x % 32);
}

struct flood {
    bit_plane open;
    bit_plane reached;
};

/* True when the cell is reached now and was not before. */
static bool spread(struct flood *flood, int32_t x, int32_t y)
{
    const bool joins = has_bit(flood->open, x, y) && !has_bit(flood->reached, x, y) &&
                       (has_bit(flood->reached, x - 1, y) || has_bit(flood->reached, x + 1, y) ||
                        has_bit(flood->reached, x, y - 1) || has_bit(flood->reached, x, y + 1));
    if (joins) {
        set_bit(flood->reached, x, y);
    }
    return joins;
}

/* One pass over all cells forward and one back. */
static bool sweep(struct flood *flood)
{
    bool changed = false;
    for (int32_t i = 0; i < CELLS; i++) {
        changed |= spread(flood, i % SCENE_SIDE, i / SCENE_SIDE);
    }
    for (int32_t i = CELLS - 1; i >= 0; i--) {
        changed |= spread(flood, i % SCENE_SIDE, i / SCENE_SIDE);
    }
    return changed;
}

static bool is_connected(const struct jp_terrain *terrain, const struct scene_task *task)
{
    struct flood flood = {0};
    for (int32_t i = 0; i < CELLS; i++) {
        const int32_t x = i % SCENE_SIDE;
        const int32_t y = i / SCENE_SIDE;
        if (jp_terrain_is_clear(terrain, disc, sizeof disc / sizeof disc[0], x, y)) {
            set_bit(flood.open, x, y);
        }
    }
    set_bit(flood.reached, task->start.x, task->start.y);
    while (!has_bit(flood.reached, task->goal.x, task->goal.y) && sweep(&flood)) {
    }
    return has_bit(flood.reached, task->goal.x, task->goal.y);
}

/* ---- Scene ---- */

const struct jp_terrain_config scene_terrain_config = {
    .width = SCENE_SIDE, .height = SCENE_SIDE, .resolution = SCENE_RESOLUTION, .has_elevation = true};

static bool try_scene(uint32_t random, struct jp_terrain *terrain, struct scene_task *task)
{
    raise_hills(terrain, &random);
    occupy_steep_ground(terrain);
    if (!draw_task(terrain, &random, task)) {
        return false;
    }
    place_obstacles(terrain, task, &random);
    place_patches(terrain, task, random, JP_CELL_OCCUPIED); /* closed, whatever the map says of unknown cells */
    const int32_t blocked = count_blocked(terrain);
    if (blocked < SHARE_MIN || blocked > SHARE_MAX || !is_connected(terrain, task)) {
        return false;
    }
    place_patches(terrain, task, random, JP_CELL_UNKNOWN);
    return true;
}

void scene_generate(uint32_t seed, struct jp_terrain *terrain, struct scene_task *task)
{
    uint32_t random = mix(seed);
    while (!try_scene(random, terrain, task)) {
        random = mix(random + 1);
    }
}
