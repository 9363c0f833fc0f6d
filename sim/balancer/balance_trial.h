/** How well a robot balances: from how far it comes back, what push it takes, and how it stands. Its own controller, on
 * the non-linear plant with its noise. */
#ifndef JOULEPATH_SIM_BALANCER_BALANCE_TRIAL_H
#define JOULEPATH_SIM_BALANCER_BALANCE_TRIAL_H

#include "sim/balancer/rig.h"

/** Leans that are tried end here, °. */
#define BALANCE_LEAN_MAX 30.0

/** How long a push lasts, s. */
#define BALANCE_PUSH_SECONDS 0.05

/** Largest that it comes back from to a stand, of both directions the smaller. */
struct balance_limits {
    double lean_deg; /**< released at rest; at most BALANCE_LEAN_MAX */
    double push_n_s; /**< at the body's centre of mass */
};

/** Standing, after it has settled. */
struct balance_stand {
    double lean_rms_deg;
    double voltage_rms_v; /**< of a motor */
    double power_w;       /**< of the motors, from the battery */
    double wander_m;      /**< between its outermost places */
};

/** False after one line on stderr: the configuration is refused. */
bool balance_trial_limits(const struct robot_entry *entry, const struct robot_file *file, uint64_t seed,
                          struct balance_limits *limits);

/** False after one line on stderr: it is refused, or does not stand. */
bool balance_trial_stand(const struct robot_entry *entry, const struct robot_file *file, uint64_t seed,
                         struct balance_stand *stand);

#endif
