#pragma once
#include <vector>

namespace rclcpp_lifecycle
{
template<typename Message>
class LifecyclePublisher
{
public:
  void on_activate() {is_active = true;}
  void on_deactivate() {is_active = false;}
  void publish(const Message & message)
  {
    if (is_active) {
      published.push_back(message);
    }
  }

  bool is_active = false;
  std::vector<Message> published;
};
}  // namespace rclcpp_lifecycle
