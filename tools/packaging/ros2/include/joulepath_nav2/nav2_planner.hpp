/// The energy planner as a global planner of Nav2 (Jazzy): a plugin of planner_server.
#ifndef JOULEPATH_NAV2__NAV2_PLANNER_HPP_
#define JOULEPATH_NAV2__NAV2_PLANNER_HPP_

#include <functional>
#include <memory>
#include <string>

#include "geometry_msgs/msg/pose_stamped.hpp"
#include "joulepath_nav2/energy_planner.hpp"
#include "nav2_core/global_planner.hpp"
#include "nav2_costmap_2d/costmap_2d_ros.hpp"
#include "nav_msgs/msg/path.hpp"
#include "rclcpp_lifecycle/lifecycle_node.hpp"
#include "rclcpp_lifecycle/lifecycle_publisher.hpp"
#include "std_msgs/msg/float64.hpp"
#include "tf2_ros/buffer.h"

namespace joulepath_nav2
{

/// Parameters, below the plugin's name: robot ("zhang2018"), memory_kib (8192), allow_unknown (false). With each path it
/// publishes the forecast: NAME/energy and NAME/energy_deviation, J.
class Nav2Planner : public nav2_core::GlobalPlanner
{
public:
  void configure(
    const rclcpp_lifecycle::LifecycleNode::WeakPtr & parent, std::string name,
    std::shared_ptr<tf2_ros::Buffer> tf, std::shared_ptr<nav2_costmap_2d::Costmap2DROS> costmap_ros) override;
  void cleanup() override;
  void activate() override;
  void deactivate() override;

  nav_msgs::msg::Path createPlan(
    const geometry_msgs::msg::PoseStamped & start, const geometry_msgs::msg::PoseStamped & goal,
    std::function<bool()> cancel_checker) override;

private:
  using Publisher = rclcpp_lifecycle::LifecyclePublisher<std_msgs::msg::Float64>;

  Grid grid() const;
  nav_msgs::msg::Path path_of(const Plan & plan) const;
  void publish(const Plan & plan) const;

  rclcpp_lifecycle::LifecycleNode::WeakPtr parent_;
  std::shared_ptr<nav2_costmap_2d::Costmap2DROS> costmap_ros_;
  bool allow_unknown_ = false;
  std::unique_ptr<EnergyPlanner> planner_;
  std::shared_ptr<Publisher> energy_;
  std::shared_ptr<Publisher> deviation_;
};

}  // namespace joulepath_nav2

#endif  // JOULEPATH_NAV2__NAV2_PLANNER_HPP_
