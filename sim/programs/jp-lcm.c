/* The gateway between LCM and a robot on CAN as a process: goals, routes and maps in, telemetry out. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/linux/periodic.h"
#include "sim/base/command_line.h"
#include "sim/base/error.h"
#include "sim/base/stop_signal.h"
#include "sim/bus/bus_open.h"
#include "sim/lcm/lcm_gateway.h"

#define DEFAULT_URL "udpm://239.255.76.67:7667?ttl=0"
#define URL_PREFIX  "udpm://"
#define PASS_US     1000
#define FAREWELL_US 300000   /* three OperatorCommands */
#define PATIENCE_US 10000000 /* for a simulation that takes longer than that for it, or has ended */
#define REASON_SIZE 256
#define US_PER_S    INT64_C(1000000)
#define NS_PER_US   1000

enum { OPTION_LCM = COMMAND_LINE_OWN };

struct arguments {
    const char *bus;
    const char *url;
};

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    struct arguments *arguments = state->input;

    switch (key) {
    case 'b':
        arguments->bus = argument;
        return 0;
    case OPTION_LCM:
        arguments->url = argument;
        return 0;
    case ARGP_KEY_END:
        if (arguments->bus == NULL) {
            command_line_refuse(state, "--bus is needed");
        }
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* LCM says what is wrong in several lines on stderr, some of them only warnings; the first one is the reason. */

struct hearing {
    FILE *heard;
    int error_stream; /**< the real one */
};

static bool hear_begin(struct hearing *hearing)
{
    (void)fflush(stderr);
    hearing->heard = tmpfile();
    hearing->error_stream = dup(STDERR_FILENO);
    return hearing->heard != NULL && hearing->error_stream >= 0 && dup2(fileno(hearing->heard), STDERR_FILENO) >= 0;
}

/** *reason is empty when nothing was said. */
static void hear_end(struct hearing *hearing, char reason[REASON_SIZE])
{
    (void)fflush(stderr);
    (void)dup2(hearing->error_stream, STDERR_FILENO);
    (void)close(hearing->error_stream);
    rewind(hearing->heard);
    if (fgets(reason, REASON_SIZE, hearing->heard) == NULL) {
        reason[0] = '\0';
    }
    reason[strcspn(reason, "\n")] = '\0';
    (void)fclose(hearing->heard);
}

static lcm_t *start_lcm(const char *url, struct lcm_gateway *gateway, const struct jp_can_link *link)
{
    struct hearing hearing;
    char reason[REASON_SIZE];
    lcm_t *lcm;
    bool started;

    if (!hear_begin(&hearing)) {
        error_line("no temporary file: is TMPDIR full or read-only?");
        return NULL;
    }
    lcm = lcm_create(url);
    started = lcm != NULL && lcm_gateway_start(gateway, link, lcm);
    hear_end(&hearing, reason);
    if (started && reason[0] == '\0') {
        return lcm;
    }
    error_line("--lcm %s: %s; LCM takes " DEFAULT_URL " and the like, and needs a multicast route: ip link set lo "
               "multicast on; ip route add 224.0.0.0/4 dev lo",
               url, reason[0] == '\0' ? "LCM does not start" : reason);
    if (lcm != NULL) {
        lcm_destroy(lcm);
    }
    return NULL;
}

/** Of the wall at the start, then going on evenly. */
static uint64_t time_us(int64_t offset_us)
{
    return (uint64_t)(offset_us + jp_monotonic_us());
}

static int64_t wall_offset_us(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_REALTIME, &now);
    return now.tv_sec * US_PER_S + now.tv_nsec / NS_PER_US - jp_monotonic_us();
}

static void say_what_begins(const struct lcm_operator *operator, const char * what)
{
    if (operator->navigates) {
        (void)printf("jp-lcm: %s a goal on map %u\n", what, (unsigned)operator->map.id);
    } else {
        (void)printf("jp-lcm: %s a route of %u points\n", what, (unsigned)operator->commander.task.length);
    }
}

static void say_task(const struct lcm_operator *operator)
{
    switch (lcm_operator_phase(operator)) {
    case JP_OPERATOR_STANDING_UP:
        say_what_begins(operator, "standing up for");
        break;
    case JP_OPERATOR_UPLOADING:
        say_what_begins(operator, "uploading");
        break;
    case JP_OPERATOR_DRIVING:
        (void)printf("jp-lcm: driving\n");
        break;
    case JP_OPERATOR_DONE:
        (void)printf("jp-lcm: done\n");
        break;
    case JP_OPERATOR_FAILED:
        error_line("jp-lcm: %s", lcm_operator_failure_text(operator));
        break;
    case JP_OPERATOR_IDLE:
    default:
        break;
    }
    (void)fflush(stdout);
}

static void say_bus(const char *bus, enum jp_can_state state)
{
    if (state == JP_CAN_ON) {
        (void)printf("jp-lcm: %s is back\n", bus);
        (void)fflush(stdout);
    } else {
        error_line("jp-lcm: %s is %s; waiting for it", bus,
                   state == JP_CAN_DOWN ? "down or gone" : "off after too many errors");
    }
}

static void pass(struct lcm_gateway *gateway, uint64_t now_us)
{
    const struct jp_can_link *link = &gateway->link;

    (void)link->wait(link->port.context, PASS_US);
    lcm_gateway_pass(gateway, now_us);
}

static void serve(struct lcm_gateway *gateway, const char *bus, int64_t offset_us)
{
    const struct jp_can_port *port = &gateway->link.port;
    enum jp_operator_phase said = JP_OPERATOR_IDLE;
    enum jp_can_state bus_said = JP_CAN_ON;

    while (!stop_signal_came()) {
        pass(gateway, time_us(offset_us));
        if (lcm_operator_phase(&gateway->operator) != said) {
            said = lcm_operator_phase(&gateway->operator);
            say_task(&gateway->operator);
        }
        if (port->state(port->context) != bus_said) {
            bus_said = port->state(port->context);
            say_bus(bus, bus_said);
        }
    }
}

/** A robot that this program drives brakes to a stand, and another one is not disturbed. */
static void bid_farewell(struct lcm_gateway *gateway, int64_t offset_us)
{
    const uint64_t until_us = gateway->operator_us + FAREWELL_US;
    const uint64_t last_us = time_us(offset_us) + PATIENCE_US;

    lcm_operator_stop(&gateway->operator);
    while (lcm_operator_is_commanding(&gateway->operator) && gateway->operator_us < until_us &&
           time_us(offset_us) < last_us) {
        pass(gateway, time_us(offset_us));
    }
}

static void print_counts(const struct lcm_gateway *gateway)
{
    uint64_t dropped = 0;

    for (int i = 0; i < LCM_TASK_RESULTS; i++) {
        dropped += gateway->dropped[i];
    }
    (void)printf("%-34s %10" PRIu64 "\n%-34s %10" PRIu64 "\n", "LCM packets dropped", dropped,
                 "messages that LCM did not take", gateway->telemetry.unsent);
}

static bool run_on(const struct arguments *arguments, const struct jp_can_link *link)
{
    static struct lcm_gateway gateway;
    const int64_t offset_us = wall_offset_us();
    lcm_t *lcm = start_lcm(arguments->url, &gateway, link);

    if (lcm == NULL) {
        return false;
    }
    (void)printf("jp-lcm: %s on %s\n", arguments->bus, arguments->url);
    (void)fflush(stdout);
    serve(&gateway, arguments->bus, offset_us);
    bid_farewell(&gateway, offset_us);
    print_counts(&gateway);
    lcm_gateway_free(&gateway);
    lcm_destroy(lcm);
    return true;
}

static bool run(const struct arguments *arguments)
{
    struct jp_can_link link;
    bool served;

    if (strncmp(arguments->url, URL_PREFIX, strlen(URL_PREFIX)) != 0) {
        error_line("--lcm %s: not an address between processes, which begins with " URL_PREFIX ", such as " DEFAULT_URL,
                   arguments->url);
        return false;
    }
    if (!bus_open(&link, arguments->bus)) {
        return false;
    }
    served = run_on(arguments, &link);
    link.close(link.port.context);
    return served;
}

int main(int argc, char **argv)
{
    static const struct argp_option options[] = {
        {"bus", 'b', "BUS", 0, "can:INTERFACE, slcan:DEVICE or pty:NAME", 0},
        {"lcm", OPTION_LCM, "URL", 0, "where LCM is (" DEFAULT_URL ")", 0},
        {0},
    };
    static const struct argp argp = {
        options, parse_option,
        "",      "Carries goals, routes and maps from LCM to a robot on CAN, and its telemetry back.",
        NULL,    NULL,
        NULL};
    struct arguments arguments = {.url = DEFAULT_URL};

    command_line_parse(&argp, argc, argv, &arguments);
    stop_signal_catch();
    return run(&arguments) ? EXIT_SUCCESS : ERROR_EXIT;
}
