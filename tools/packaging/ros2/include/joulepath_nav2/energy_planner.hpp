/// Plans of least energy with their forecast, for skid-steered and differential-drive robots. No ROS in it.
#ifndef JOULEPATH_NAV2__ENERGY_PLANNER_HPP_
#define JOULEPATH_NAV2__ENERGY_PLANNER_HPP_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <joulepath/skid_learner.h>

namespace joulepath_nav2
{

/// m and rad, in the map's frame.
struct Pose
{
  double x;
  double y;
  double heading;
};

enum class Cell : std::uint8_t { kFree, kOccupied, kUnknown };

/// Row by row from the south-west corner.
struct Grid
{
  unsigned width = 0;
  unsigned height = 0;
  double resolution = 0;  ///< side of a cell, m; that of the robot's lattice
  double origin_x = 0;    ///< of the south-west corner, m
  double origin_y = 0;
  bool unknown_is_free = false;
  std::vector<Cell> cells;
  std::vector<float> elevation;  ///< m; empty: level
};

struct Plan
{
  std::vector<Pose> poses;  ///< at most a cell apart, from the start's cell to the goal's
  double metres = 0;
  double seconds = 0;
  double joules = 0;            ///< forecast, electronics included
  double joules_deviation = 0;  ///< standard deviation of the forecast
  bool is_optimal = false;      ///< no route of the lattice takes less
};

/// Why there is no plan.
class NoPlan : public std::runtime_error
{
public:
  enum class Reason { kStartOutside, kGoalOutside, kStartBlocked, kGoalBlocked, kUnreachable, kCancelled, kMemory, kGrid };

  NoPlan(Reason reason, const std::string & what) : std::runtime_error(what), reason_(reason) {}
  Reason reason() const {return reason_;}

private:
  Reason reason_;
};

class EnergyPlanner
{
public:
  /// A robot whose tables are built in, and the planner's memory in bytes. std::invalid_argument: there is no such robot.
  EnergyPlanner(const std::string & robot, std::size_t memory);
  ~EnergyPlanner();
  EnergyPlanner(const EnergyPlanner &) = delete;
  EnergyPlanner & operator=(const EnergyPlanner &) = delete;

  static std::vector<std::string> robots();

  /// Side of the cells that its grids must have, m.
  double resolution() const;

  /// Forecasts follow what a robot has learned. std::invalid_argument: it is of other tables.
  void restore(const jp_learned_state & state);

  /// The cheapest route to the goal, at its heading. Between slices of a few milliseconds it asks `is_cancelled`. Throws
  /// NoPlan.
  Plan plan(
    const Grid & grid, const Pose & start, const Pose & goal,
    const std::function<bool()> & is_cancelled = [] {return false;});

private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace joulepath_nav2

#endif  // JOULEPATH_NAV2__ENERGY_PLANNER_HPP_
