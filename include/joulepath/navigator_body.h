/** What a navigator knows of a robot's body: made of its robot file by `make lattice`. */
#ifndef JOULEPATH_NAVIGATOR_BODY_H
#define JOULEPATH_NAVIGATOR_BODY_H

#include <joulepath/fixed.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jp_navigator_body {
    jp_q16 radius; /**< of the disc in which it turns, m */
    jp_q16 margin; /**< which it leaves its trajectory by at most, m */
};

#ifdef __cplusplus
}
#endif

#endif
