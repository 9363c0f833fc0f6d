/** What may happen to a robot at any time. A driver says whose: ROBOT, the name of its struct and what its functions
 * begin with, and ORDER, the struct by which it is driven. */
#ifndef JOULEPATH_TESTS_PROOF_ANY_ROBOT_H
#define JOULEPATH_TESTS_PROOF_ANY_ROBOT_H

#include "tests/proof/any_board.h"

#define JOINED(prefix, name)      prefix##name
#define NAME_JOINED(prefix, name) JOINED(prefix, name)
#define OF_ROBOT(name)            NAME_JOINED(ROBOT, name)

/** On, off, or driven by anything. */
static void command(struct ROBOT *robot)
{
    struct ORDER order;

    ANY(order);
    switch (any_between(0, 2)) {
    case 0:
        (void)OF_ROBOT(_enable)(robot);
        break;
    case 1:
        OF_ROBOT(_disable)(robot);
        break;
    default:
        (void)OF_ROBOT(_drive)(robot, &order);
        break;
    }
}

#endif
