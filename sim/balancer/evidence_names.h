/** What reports call the findings about measured energies (joulepath/evidence.h, joulepath/current_check.h). */
#ifndef JOULEPATH_SIM_BALANCER_EVIDENCE_NAMES_H
#define JOULEPATH_SIM_BALANCER_EVIDENCE_NAMES_H

#include <joulepath/evidence.h>
#include <stddef.h>

/** Such as "samples dropped". */
const char *evidence_name(enum jp_evidence evidence);

#define CURRENT_FINDINGS_SIZE 128

/** All that was found, such as "left offset, changing", or "none"; CURRENT_FINDINGS_SIZE holds any. */
void current_findings_name(uint8_t findings, char text[CURRENT_FINDINGS_SIZE]);

#endif
