/** A program of somebody who uses the part in floating point. Exit status 0: it got a sensible distance. C and C++. */
#include <joulepath/obstacles.h>

int main(void)
{
    static struct jp_obstacles obstacles;
    static struct jp_obstacle disc;
    const struct jp_footprint footprint = {0.5f, 0.5f, 0.25f};
    const struct jp_plane_point centre = {0.0f, 0.0f};
    const struct jp_plane_pose pose = {1.0f, 0.0f, 0.0f};

    disc.vertices[0].x = 3.0f;
    disc.vertex_count = 1;
    disc.radius = 0.5f;
    jp_obstacles_clear(&obstacles, &centre);
    if (jp_obstacles_add(&obstacles, &disc) != JP_OK) {
        return 1;
    }

    const float distance = jp_obstacles_distance(&obstacles, &footprint, &pose);

    return distance > 0.999f && distance < 1.001f ? 0 : 2;
}
