#include "joulepath_nav2/nav2_planner.hpp"

#include <cmath>
#include <mutex>
#include <stdexcept>

#include "nav2_core/planner_exceptions.hpp"
#include "nav2_costmap_2d/cost_values.hpp"
#include "nav2_util/node_utils.hpp"
#include "pluginlib/class_list_macros.hpp"

namespace joulepath_nav2
{
namespace
{

/// The lattice sweeps the robot's own outline: what a costmap inflates round obstacles is none.
Cell cell_of(unsigned char cost)
{
  if (cost == nav2_costmap_2d::NO_INFORMATION) {
    return Cell::kUnknown;
  }
  return cost == nav2_costmap_2d::LETHAL_OBSTACLE ? Cell::kOccupied : Cell::kFree;
}

Pose pose_of(const geometry_msgs::msg::Pose & pose)
{
  const auto & q = pose.orientation;
  return {pose.position.x, pose.position.y,
    std::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))};
}

[[noreturn]] void rethrow(const NoPlan & error)
{
  switch (error.reason()) {
    case NoPlan::Reason::kStartOutside:
      throw nav2_core::StartOutsideMapBounds(error.what());
    case NoPlan::Reason::kGoalOutside:
      throw nav2_core::GoalOutsideMapBounds(error.what());
    case NoPlan::Reason::kStartBlocked:
      throw nav2_core::StartOccupied(error.what());
    case NoPlan::Reason::kGoalBlocked:
      throw nav2_core::GoalOccupied(error.what());
    case NoPlan::Reason::kUnreachable:
      throw nav2_core::NoValidPathCouldBeFound(error.what());
    case NoPlan::Reason::kCancelled:
      throw nav2_core::PlannerCancelled(error.what());
    case NoPlan::Reason::kMemory:
    case NoPlan::Reason::kGrid:
      break;
  }
  throw nav2_core::PlannerException(error.what());
}

std_msgs::msg::Float64 number(double value)
{
  std_msgs::msg::Float64 message;
  message.data = value;
  return message;
}

}  // namespace

void Nav2Planner::configure(
  const rclcpp_lifecycle::LifecycleNode::WeakPtr & parent, std::string name, std::shared_ptr<tf2_ros::Buffer>,
  std::shared_ptr<nav2_costmap_2d::Costmap2DROS> costmap_ros)
{
  const auto node = parent.lock();
  if (!node) {
    throw nav2_core::PlannerException("joulepath: the node is gone");
  }
  parent_ = parent;
  costmap_ros_ = costmap_ros;

  const auto declare = [&](const char * key, const rclcpp::ParameterValue & value) {
      nav2_util::declare_parameter_if_not_declared(node, name + "." + key, value);
    };
  std::string robot;
  int memory_kib = 0;
  declare("robot", rclcpp::ParameterValue(std::string("zhang2018")));
  declare("memory_kib", rclcpp::ParameterValue(8192));
  declare("allow_unknown", rclcpp::ParameterValue(false));
  node->get_parameter(name + ".robot", robot);
  node->get_parameter(name + ".memory_kib", memory_kib);
  node->get_parameter(name + ".allow_unknown", allow_unknown_);
  if (memory_kib <= 0) {
    throw nav2_core::PlannerException(name + ".memory_kib: must be above 0");
  }
  try {
    planner_ = std::make_unique<EnergyPlanner>(robot, static_cast<std::size_t>(memory_kib) * 1024);
  } catch (const std::invalid_argument & error) {
    throw nav2_core::PlannerException(name + "." + error.what());
  }
  energy_ = node->create_publisher<std_msgs::msg::Float64>(name + "/energy", 1);
  deviation_ = node->create_publisher<std_msgs::msg::Float64>(name + "/energy_deviation", 1);
}

void Nav2Planner::cleanup()
{
  planner_.reset();
  energy_.reset();
  deviation_.reset();
}

void Nav2Planner::activate()
{
  energy_->on_activate();
  deviation_->on_activate();
}

void Nav2Planner::deactivate()
{
  energy_->on_deactivate();
  deviation_->on_deactivate();
}

nav_msgs::msg::Path Nav2Planner::createPlan(
  const geometry_msgs::msg::PoseStamped & start, const geometry_msgs::msg::PoseStamped & goal,
  std::function<bool()> cancel_checker)
{
  const std::string frame = costmap_ros_->getGlobalFrameID();
  if (start.header.frame_id != frame || goal.header.frame_id != frame) {
    throw nav2_core::PlannerTFError("start and goal must be in the frame " + frame);
  }
  try {
    const Plan plan = planner_->plan(grid(), pose_of(start.pose), pose_of(goal.pose), cancel_checker);
    publish(plan);
    return path_of(plan);
  } catch (const NoPlan & error) {
    rethrow(error);
  }
}

Grid Nav2Planner::grid() const
{
  nav2_costmap_2d::Costmap2D & costmap = *costmap_ros_->getCostmap();
  const std::unique_lock<nav2_costmap_2d::Costmap2D::mutex_t> lock(*costmap.getMutex());
  Grid grid;
  grid.width = costmap.getSizeInCellsX();
  grid.height = costmap.getSizeInCellsY();
  grid.resolution = costmap.getResolution();
  grid.origin_x = costmap.getOriginX();
  grid.origin_y = costmap.getOriginY();
  grid.unknown_is_free = allow_unknown_;
  const unsigned char * costs = costmap.getCharMap();
  const std::size_t count = static_cast<std::size_t>(grid.width) * grid.height;
  grid.cells.reserve(count);
  for (std::size_t i = 0; i < count; i++) {
    grid.cells.push_back(cell_of(costs[i]));
  }
  return grid;
}

nav_msgs::msg::Path Nav2Planner::path_of(const Plan & plan) const
{
  nav_msgs::msg::Path path;
  path.header.frame_id = costmap_ros_->getGlobalFrameID();
  if (const auto node = parent_.lock()) {
    path.header.stamp = node->now();
  }
  for (const Pose & each : plan.poses) {
    geometry_msgs::msg::PoseStamped pose;
    pose.header = path.header;
    pose.pose.position.x = each.x;
    pose.pose.position.y = each.y;
    pose.pose.orientation.z = std::sin(each.heading / 2);
    pose.pose.orientation.w = std::cos(each.heading / 2);
    path.poses.push_back(pose);
  }
  return path;
}

void Nav2Planner::publish(const Plan & plan) const
{
  energy_->publish(number(plan.joules));
  deviation_->publish(number(plan.joules_deviation));
}

}  // namespace joulepath_nav2

PLUGINLIB_EXPORT_CLASS(joulepath_nav2::Nav2Planner, nav2_core::GlobalPlanner)
