/** Any configuration with a name. */
#include "hal/storage/parameters.h"
#include "tests/proof/any.h"

int main(void)
{
    static struct jp_robot_config balancer;
    static struct jp_skid_robot_config skid;
    static struct jp_four_wheel_robot_config four_wheel;

    ANY(balancer);
    ANY(skid);
    ANY(four_wheel);
    balancer.name = "any";
    skid.name = "any";
    (void)jp_robot_identity(&balancer);
    (void)jp_skid_robot_identity(&skid);
    (void)jp_four_wheel_robot_identity(&four_wheel);
    ARRIVED();
    return 0;
}
