#pragma once
#include <any>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>

#include "geometry_msgs/msg/pose_stamped.hpp"
#include "rclcpp_lifecycle/lifecycle_publisher.hpp"

namespace rclcpp
{
using ParameterValue = std::variant<bool, int, std::string>;
}  // namespace rclcpp

namespace rclcpp_lifecycle
{
class LifecycleNode
{
public:
  using SharedPtr = std::shared_ptr<LifecycleNode>;
  using WeakPtr = std::weak_ptr<LifecycleNode>;

  template<typename Value>
  bool get_parameter(const std::string & name, Value & value) const
  {
    value = std::get<Value>(parameters.at(name));
    return true;
  }

  template<typename Message>
  std::shared_ptr<LifecyclePublisher<Message>> create_publisher(const std::string & topic, int)
  {
    auto publisher = std::make_shared<LifecyclePublisher<Message>>();
    publishers[topic] = publisher;
    return publisher;
  }

  builtin_interfaces::msg::Time now() const {return {7, 0};}

  std::map<std::string, rclcpp::ParameterValue> parameters;
  std::map<std::string, std::any> publishers;
};
}  // namespace rclcpp_lifecycle
