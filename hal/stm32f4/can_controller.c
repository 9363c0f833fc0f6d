#include "hal/stm32f4/can_controller.h"

#include "hal/stm32f4/board.h"
#include "hal/stm32f4/stm32f405.h"
#include "hal/stm32f4/wait.h"

#define STANDARD_ID_MAX 0x7FFU

#define MAILBOXES 3U

/** Leaves in order, keeps the older frame when the input is full, comes back from bus-off by itself. */
#define MODE (CAN_MCR_TXFP | CAN_MCR_RFLM | CAN_MCR_ABOM)

#define INTERRUPTS  (CAN_IER_TMEIE | CAN_IER_FMPIE0 | CAN_IER_BOFIE | CAN_IER_ERRIE)
#define SENT        (CAN_TSR_RQCP0 | CAN_TSR_RQCP1 | CAN_TSR_RQCP2)
#define ABORT       (CAN_TSR_ABRQ0 | CAN_TSR_ABRQ1 | CAN_TSR_ABRQ2)
#define FIRST       1U      /* filter 0 */
#define MODE_POLLS  200000U /* 10 ms at least */
#define FRAMES_MASK 3U
#define DLC_MASK    0xFU

static void count(uint16_t *counter, unsigned events)
{
    *counter = events < (unsigned)(UINT16_MAX - *counter) ? (uint16_t)(*counter + events) : UINT16_MAX;
}

/* Start. */

/** Filter 0 lets every standard data frame into the first FIFO: kind of id and remote request must be 0. */
static void accept_standard_data(void)
{
    CAN1.FMR |= CAN_FMR_FINIT;
    CAN1.FA1R = 0;
    CAN1.FM1R = 0;
    CAN1.FS1R = FIRST;
    CAN1.FFA1R = 0;
    CAN1.F[0].R1 = 0;
    CAN1.F[0].R2 = CAN_RIR_IDE | CAN_RIR_RTR;
    CAN1.FA1R = FIRST;
    CAN1.FMR &= ~CAN_FMR_FINIT;
}

static bool is_configured(void)
{
    CAN1.MCR = MODE | CAN_MCR_INRQ;
    if (!jp_wait_for(&CAN1.MSR, CAN_MSR_INAK, CAN_MSR_INAK, MODE_POLLS)) {
        return false;
    }
    CAN1.BTR = CAN_BTR_BRP(BOARD_CAN_PRESCALER - 1U) | CAN_BTR_TS1(BOARD_CAN_SEGMENT_1 - 1U) |
               CAN_BTR_TS2(BOARD_CAN_SEGMENT_2 - 1U) | CAN_BTR_SJW(BOARD_CAN_JUMP_WIDTH - 1U);
    accept_standard_data();
    return true;
}

/** Off the bus again when it does not let the controller on. */
static bool joins(void)
{
    CAN1.MCR = MODE;
    if (jp_wait_for(&CAN1.MSR, CAN_MSR_INAK, 0, MODE_POLLS)) {
        return true;
    }
    CAN1.MCR = MODE | CAN_MCR_INRQ;
    return false;
}

bool jp_can_controller_start(struct jp_can_controller *can, jp_can_receiver receive, void *context)
{
    *can = (struct jp_can_controller){.receive = receive, .context = context};
    jp_pin_listen(BOARD_CAN_RX);
    jp_pin_drive(BOARD_CAN_TX);
    RCC.APB1ENR |= RCC_APB1ENR_CAN1EN;
    can->present = is_configured() && joins();
    if (can->present) {
        CAN1.IER = INTERRUPTS;
    }
    return can->present;
}

/* Out. */

static uint32_t word_of(const uint8_t *bytes)
{
    return bytes[0] | ((uint32_t)bytes[1] << 8) | ((uint32_t)bytes[2] << 16) | ((uint32_t)bytes[3] << 24);
}

static void fill(volatile struct stm32_can_mailbox *mailbox, const struct jp_can_frame *frame)
{
    mailbox->DTR = CAN_TDTR_DLC(frame->length);
    mailbox->DLR = word_of(&frame->data[0]);
    mailbox->DHR = word_of(&frame->data[4]);
    mailbox->IR = CAN_TIR_STID(frame->id) | CAN_TIR_TXRQ;
}

/** `status` is TSR. */
static void fill_mailboxes(struct jp_can_controller *can, uint32_t status)
{
    for (unsigned i = 0; i < MAILBOXES && can->waiting > 0U; i++) {
        if ((status & (CAN_TSR_TME0 << i)) != 0U) {
            fill(&CAN1.T[i], &can->queue[can->first]);
            can->first = (uint8_t)((can->first + 1U) % JP_CAN_QUEUE);
            can->waiting--;
        }
    }
}

static enum jp_can_state state(void *context)
{
    const struct jp_can_controller *can = context;

    if (!can->present) {
        return JP_CAN_DOWN;
    }
    return (CAN1.ESR & CAN_ESR_BOFF) != 0U ? JP_CAN_BUS_OFF : JP_CAN_ON;
}

static enum jp_status send(void *context, const struct jp_can_frame *frame)
{
    struct jp_can_controller *can = context;

    if (frame->id > STANDARD_ID_MAX || frame->length > JP_CAN_LENGTH_MAX) {
        return JP_ERR_ARGUMENT;
    }
    if (state(can) != JP_CAN_ON) {
        return JP_ERR_HARDWARE;
    }
    if (can->waiting == JP_CAN_QUEUE) {
        return JP_ERR_BUSY;
    }
    can->queue[(can->first + can->waiting) % JP_CAN_QUEUE] = *frame;
    can->waiting++;
    fill_mailboxes(can, CAN1.TSR);
    return JP_OK;
}

struct jp_can_port jp_can_controller_port(struct jp_can_controller *can)
{
    return (struct jp_can_port){.context = can, .send = send, .state = state};
}

void jp_can_controller_on_transmit(struct jp_can_controller *can)
{
    const uint32_t status = CAN1.TSR;

    CAN1.TSR = status & SENT; /* a mailbox that becomes empty from now on interrupts again */
    fill_mailboxes(can, status);
}

/* In. */

static void split(uint32_t word, uint8_t *bytes)
{
    for (unsigned i = 0; i < 4U; i++) {
        bytes[i] = (uint8_t)(word >> (8U * i));
    }
}

static struct jp_can_frame frame_in(const volatile struct stm32_can_mailbox *mailbox)
{
    const uint32_t length = mailbox->DTR & DLC_MASK;
    struct jp_can_frame frame = {.id = (mailbox->IR / CAN_RIR_STID(1)) & STANDARD_ID_MAX,
                                 .length = (uint8_t)(length < JP_CAN_LENGTH_MAX ? length : JP_CAN_LENGTH_MAX)};

    split(mailbox->DLR, &frame.data[0]);
    split(mailbox->DHR, &frame.data[4]);
    return frame;
}

void jp_can_controller_on_receive(struct jp_can_controller *can)
{
    const uint32_t status = CAN1.RF0R;
    struct jp_can_frame frame;

    if ((status & CAN_RF0R_FOVR0) != 0U) {
        count(&can->overruns, 1);
        CAN1.RF0R = CAN_RF0R_FOVR0;
    }
    if ((status & CAN_RF0R_RFOM0) != 0U || (status & CAN_RF0R_FMP0(FRAMES_MASK)) == 0U) {
        return;
    }
    frame = frame_in(&CAN1.R[0]);
    CAN1.RF0R = CAN_RF0R_RFOM0;
    can->receive(can->context, &frame);
}

/* Errors. */

static unsigned mailboxes_in_use(void)
{
    const uint32_t status = CAN1.TSR;
    unsigned used = 0;

    for (unsigned i = 0; i < MAILBOXES; i++) {
        used += (status & (CAN_TSR_TME0 << i)) == 0U ? 1U : 0U;
    }
    return used;
}

void jp_can_controller_on_error(struct jp_can_controller *can)
{
    if ((CAN1.MSR & CAN_MSR_ERRI) == 0U) {
        return;
    }
    CAN1.MSR = CAN_MSR_ERRI;
    count(&can->bus_offs, 1);
    count(&can->dropped, can->waiting + mailboxes_in_use());
    can->waiting = 0;
    CAN1.TSR = ABORT;
}
