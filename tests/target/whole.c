/** An image that holds the libraries as a whole, for measuring. The debugger's information of this file, which holds
 * all types, tells tools/measure/size.py the sizes of structs. */
#include <joulepath/planner.h>
#include <joulepath/robot.h>

#include "hal/app/ecu.h"

int main(void)
{
    return 0;
}
