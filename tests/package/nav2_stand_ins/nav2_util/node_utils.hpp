#pragma once
#include <string>

#include "rclcpp_lifecycle/lifecycle_node.hpp"

namespace nav2_util
{
template<typename Node>
void declare_parameter_if_not_declared(Node node, const std::string & name, const rclcpp::ParameterValue & value)
{
  node->parameters.emplace(name, value);
}
}  // namespace nav2_util
