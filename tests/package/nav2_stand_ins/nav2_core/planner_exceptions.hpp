#pragma once
#include <stdexcept>
#include <string>

namespace nav2_core
{
class PlannerException : public std::runtime_error
{
public:
  explicit PlannerException(const std::string & description) : std::runtime_error(description) {}
};

#define STAND_IN(name) \
  class name : public PlannerException \
  { \
public: \
    explicit name(const std::string & description) : PlannerException(description) {} \
  }
STAND_IN(StartOccupied);
STAND_IN(GoalOccupied);
STAND_IN(StartOutsideMapBounds);
STAND_IN(GoalOutsideMapBounds);
STAND_IN(NoValidPathCouldBeFound);
STAND_IN(PlannerCancelled);
STAND_IN(PlannerTFError);
#undef STAND_IN
}  // namespace nav2_core
