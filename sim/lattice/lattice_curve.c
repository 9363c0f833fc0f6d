#include "sim/lattice/lattice_curve.h"

#include <math.h>

#include "sim/base/strict_math.h"

#define NEWTON_STEPS   50
#define END_TOLERANCE  1e-11 /* cells and rad */
#define DIFFERENCE     1e-6  /* of each unknown, for the derivatives */
#define PIECES_A_CURVE 32

enum { UNKNOWNS = 3 };

static double heading_at(const struct lattice_curve *curve, double s)
{
    return curve->heading + (curve->bend + curve->bend_rate * s / 2) * s;
}

/* Integrates the position from arc length s to s + step by Gauss-Legendre quadrature with three points. */
static void advance(const struct lattice_curve *curve, double s, double step, struct lattice_pose *pose)
{
    static const double points[] = {-0.774596669241483377, 0, 0.774596669241483377};
    static const double weights[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

    for (int i = 0; i < 3; i++) {
        const struct strict_turn turn = strict_sin_cos(heading_at(curve, s + step * (1 + points[i]) / 2));
        pose->x += weights[i] * step * turn.cosine;
        pose->y += weights[i] * step * turn.sine;
    }
    pose->heading = heading_at(curve, s + step);
}

struct lattice_pose lattice_curve_end(const struct lattice_curve *curve)
{
    struct lattice_pose pose = {0, 0, curve->heading};
    const double step = curve->length / PIECES_A_CURVE;

    for (int i = 0; i < PIECES_A_CURVE; i++) {
        advance(curve, i * step, step, &pose);
    }
    return pose;
}

double lattice_curve_sharpest(const struct lattice_curve *curve)
{
    return fmax(fabs(curve->bend), fabs(curve->bend + curve->bend_rate * curve->length));
}

static void miss(const struct lattice_curve *curve, const struct lattice_pose *end, double error[UNKNOWNS])
{
    const struct lattice_pose reached = lattice_curve_end(curve);

    error[0] = reached.x - end->x;
    error[1] = reached.y - end->y;
    error[2] = reached.heading - end->heading;
}

static double determinant(const double m[UNKNOWNS][UNKNOWNS])
{
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* The Jacobian of the end pose's error with respect to bend, bend rate and length, by central differences. */
static void derive(const struct lattice_curve *curve, const struct lattice_pose *end,
                   double jacobian[UNKNOWNS][UNKNOWNS])
{
    const struct lattice_curve moved[UNKNOWNS][2] = {
        {{curve->heading, curve->bend - DIFFERENCE, curve->bend_rate, curve->length},
         {curve->heading, curve->bend + DIFFERENCE, curve->bend_rate, curve->length}},
        {{curve->heading, curve->bend, curve->bend_rate - DIFFERENCE, curve->length},
         {curve->heading, curve->bend, curve->bend_rate + DIFFERENCE, curve->length}},
        {{curve->heading, curve->bend, curve->bend_rate, curve->length - DIFFERENCE},
         {curve->heading, curve->bend, curve->bend_rate, curve->length + DIFFERENCE}},
    };

    for (int unknown = 0; unknown < UNKNOWNS; unknown++) {
        double low[UNKNOWNS];
        double high[UNKNOWNS];
        miss(&moved[unknown][0], end, low);
        miss(&moved[unknown][1], end, high);
        for (int row = 0; row < UNKNOWNS; row++) {
            jacobian[row][unknown] = (high[row] - low[row]) / (2 * DIFFERENCE);
        }
    }
}

/* Cramer's rule. False when the matrix is singular. */
static bool solve(const double matrix[UNKNOWNS][UNKNOWNS], const double right[UNKNOWNS], double solution[UNKNOWNS])
{
    const double scale = determinant(matrix);
    if (fabs(scale) < 1e-12) {
        return false;
    }
    for (int unknown = 0; unknown < UNKNOWNS; unknown++) {
        double replaced[UNKNOWNS][UNKNOWNS];
        for (int row = 0; row < UNKNOWNS; row++) {
            for (int column = 0; column < UNKNOWNS; column++) {
                replaced[row][column] = column == unknown ? right[row] : matrix[row][column];
            }
        }
        solution[unknown] = determinant(replaced) / scale;
    }
    return true;
}

bool lattice_curve_solve(struct lattice_curve *curve, const struct lattice_pose *end)
{
    for (int i = 0; i < NEWTON_STEPS; i++) {
        double error[UNKNOWNS];
        double jacobian[UNKNOWNS][UNKNOWNS];
        double step[UNKNOWNS];

        miss(curve, end, error);
        if (fmax(fabs(error[0]), fmax(fabs(error[1]), fabs(error[2]))) < END_TOLERANCE) {
            return curve->length > 0;
        }
        derive(curve, end, jacobian);
        if (!solve(jacobian, error, step)) {
            return false;
        }
        curve->bend -= step[0];
        curve->bend_rate -= step[1];
        curve->length -= step[2];
    }
    return false;
}

bool lattice_curve_path(const struct lattice_curve *curve, double spacing, double turn, struct lattice_path *path)
{
    const double sharpest = fmax(lattice_curve_sharpest(curve) * curve->length / turn, curve->length / spacing);
    if (!(sharpest < LATTICE_POSES_MAX - 1)) {
        return false;
    }
    const size_t pieces = (size_t)ceil(sharpest);
    const double step = curve->length / (double)pieces;

    path->poses[0] = (struct lattice_pose){0, 0, curve->heading};
    for (size_t i = 0; i < pieces; i++) {
        path->poses[i + 1] = path->poses[i];
        advance(curve, (double)i * step, step, &path->poses[i + 1]);
    }
    path->count = pieces + 1;
    return true;
}
