#include "sim/balancer/evidence_names.h"

#include <stdio.h>

static const char *const evidence_names[JP_EVIDENCES] = {
    [JP_EVIDENCE_GOOD] = "good",
    [JP_EVIDENCE_INCOMPLETE] = "incomplete",
    [JP_EVIDENCE_DROPPED] = "samples dropped",
    [JP_EVIDENCE_SATURATED] = "voltage saturated",
    [JP_EVIDENCE_BATTERY] = "battery at its limits",
    [JP_EVIDENCE_CURRENT] = "current sensor in doubt",
};

/* By bit. */
static const char *const finding_names[] = {
    "left offset", "right offset", "left gain", "right gain", "current gain or motor resistance", "changing",
};

const char *evidence_name(enum jp_evidence evidence)
{
    return evidence_names[evidence];
}

void current_findings_name(uint8_t findings, char text[CURRENT_FINDINGS_SIZE])
{
    size_t length = 0;

    (void)snprintf(text, CURRENT_FINDINGS_SIZE, "none");
    for (unsigned bit = 0; bit < sizeof finding_names / sizeof finding_names[0]; bit++) {
        if ((findings & 1U << bit) != 0) {
            length += (size_t)snprintf(text + length, CURRENT_FINDINGS_SIZE - length, "%s%s", length == 0 ? "" : ", ",
                                       finding_names[bit]);
        }
    }
}
