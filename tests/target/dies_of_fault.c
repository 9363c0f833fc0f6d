/** Reads where no board has memory. */
#include <stdint.h>

int main(void)
{
    (void)*(volatile uint32_t *)UINT32_C(0xF0000000);
    return 0;
}
