#pragma once
#include <string>

namespace builtin_interfaces::msg
{
struct Time
{
  int sec = 0;
  unsigned nanosec = 0;
};
}  // namespace builtin_interfaces::msg

namespace std_msgs::msg
{
struct Header
{
  builtin_interfaces::msg::Time stamp;
  std::string frame_id;
};
}  // namespace std_msgs::msg

namespace geometry_msgs::msg
{
struct Point
{
  double x = 0, y = 0, z = 0;
};
struct Quaternion
{
  double x = 0, y = 0, z = 0, w = 1;
};
struct Pose
{
  Point position;
  Quaternion orientation;
};
struct PoseStamped
{
  std_msgs::msg::Header header;
  Pose pose;
};
}  // namespace geometry_msgs::msg
