/** Any bytes retained, any snapshots. */
#include "hal/app/retained.h"
#include "tests/proof/any.h"

int main(void)
{
    static struct jp_retained retained;
    union jp_retained_snapshot snapshot;

    ANY(retained);
    ANY(snapshot);
    (void)jp_retained_newest(&retained);
    jp_retained_write(&retained, (enum jp_retained_kind)any_between(1, 3), &snapshot, any_unsigned(UINT32_MAX));
    (void)jp_retained_newest(&retained);
    ARRIVED();
    return 0;
}
