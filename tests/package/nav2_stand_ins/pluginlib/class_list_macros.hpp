#pragma once
#include <memory>

// What a class loader would make of it.
#define PLUGINLIB_EXPORT_CLASS(type, base) \
  std::shared_ptr<base> make_plugin(); \
  std::shared_ptr<base> make_plugin() {return std::make_shared<type>();}
