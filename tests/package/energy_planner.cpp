// The energy planner and its plugin for Nav2, on stand-ins of Nav2.
#include <any>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "joulepath_nav2/nav2_planner.hpp"
#include "nav2_core/planner_exceptions.hpp"
#include "nav2_costmap_2d/cost_values.hpp"

std::shared_ptr<nav2_core::GlobalPlanner> make_plugin();

namespace
{

using joulepath_nav2::Cell;
using joulepath_nav2::EnergyPlanner;
using joulepath_nav2::Grid;
using joulepath_nav2::NoPlan;
using joulepath_nav2::Plan;
using joulepath_nav2::Pose;

constexpr std::size_t kMemory = std::size_t{8} << 20;
constexpr double kPi = 3.14159265358979323846;

void check(bool is_good, const char * what, int line)
{
  if (!is_good) {
    std::fprintf(stderr, "energy_planner.cpp:%d: %s\n", line, what);
    std::exit(1);
  }
}
#define CHECK(condition) check(condition, #condition, __LINE__)

template<typename Error, typename Call>
std::string error_of(Call call)
{
  try {
    call();
  } catch (const Error & error) {
    return error.what();
  }
  return "";
}

template<typename Call>
bool fails_for(NoPlan::Reason reason, Call call)
{
  try {
    call();
  } catch (const NoPlan & error) {
    return error.reason() == reason;
  }
  return false;
}

/// A wall with a gap, origin at (10, 20) m.
Grid room(double resolution)
{
  Grid grid;
  grid.width = 60;
  grid.height = 40;
  grid.resolution = resolution;
  grid.origin_x = 10;
  grid.origin_y = 20;
  grid.cells.assign(std::size_t{60} * 40, Cell::kFree);
  for (unsigned y = 0; y < 28; y++) {
    grid.cells[y * 60 + 26] = Cell::kOccupied;
  }
  return grid;
}

Pose at(const Grid & grid, double column, double row, double heading)
{
  return {grid.origin_x + column * grid.resolution, grid.origin_y + row * grid.resolution, heading};
}

double distance(const Pose & a, const Pose & b)
{
  return std::hypot(a.x - b.x, a.y - b.y);
}

void plans_round_a_wall(const std::string & robot)
{
  EnergyPlanner planner(robot, kMemory);
  const Grid grid = room(planner.resolution());
  const Pose start = at(grid, 8.5, 20.5, kPi / 2);
  const Pose goal = at(grid, 50.5, 20.5, -kPi / 2);
  const Plan plan = planner.plan(grid, start, goal);

  CHECK(plan.is_optimal && plan.joules > 0 && plan.joules_deviation > 0 && plan.seconds > 0);
  CHECK(distance(plan.poses.front(), start) < grid.resolution && distance(plan.poses.back(), goal) < grid.resolution);
  double length = 0;
  for (std::size_t i = 1; i < plan.poses.size(); i++) {
    const double step = distance(plan.poses[i - 1], plan.poses[i]);
    CHECK(step < 1.01 * grid.resolution);
    length += step;
    const auto column = static_cast<unsigned>((plan.poses[i].x - grid.origin_x) / grid.resolution);
    const auto row = static_cast<unsigned>((plan.poses[i].y - grid.origin_y) / grid.resolution);
    CHECK(grid.cells[row * grid.width + column] == Cell::kFree);
  }
  CHECK(std::abs(length - plan.metres) < 0.01 * plan.metres);
  CHECK(std::abs(std::remainder(plan.poses.back().heading - goal.heading, 2 * kPi)) < kPi / 16 + 1e-6);
}

void hills_cost_and_are_gone_round()
{
  EnergyPlanner planner("zhang2018", kMemory);
  Grid grid = room(planner.resolution());
  grid.cells.assign(grid.cells.size(), Cell::kFree);
  const Pose start = at(grid, 8.5, 20.5, 0);
  const Pose goal = at(grid, 50.5, 20.5, 0);
  const Plan level = planner.plan(grid, start, goal);
  grid.elevation.resize(grid.cells.size());
  for (unsigned y = 0; y < grid.height; y++) {
    for (unsigned x = 0; x < grid.width; x++) {
      const double off = std::hypot(x - 30.0, y - 18.0) / 8;
      grid.elevation[y * grid.width + x] = static_cast<float>(1.5 * std::exp(-off * off));
    }
  }
  const Plan hill = planner.plan(grid, start, goal);
  CHECK(hill.joules > level.joules && hill.metres > level.metres);
}

void what_was_learned_counts()
{
  EnergyPlanner planner("zhang2018", kMemory);
  const Grid grid = room(planner.resolution());
  const Plan before = planner.plan(grid, at(grid, 8, 20, 0), at(grid, 20, 20, 0));
  jp_learned_state state{};
  CHECK(!error_of<std::invalid_argument>([&] {planner.restore(state);}).empty());
  CHECK(planner.plan(grid, at(grid, 8, 20, 0), at(grid, 20, 20, 0)).joules == before.joules);
}

void nothing_to_do_takes_nothing()
{
  EnergyPlanner planner("zhang2018", kMemory);
  const Grid grid = room(planner.resolution());
  const Plan plan = planner.plan(grid, at(grid, 8.2, 20.2, 0), at(grid, 8.4, 20.4, 0));
  CHECK(plan.poses.size() == 2 && plan.joules == 0);
}

void says_why_there_is_no_plan()
{
  EnergyPlanner planner("zhang2018", kMemory);
  Grid grid = room(planner.resolution());
  const Pose start = at(grid, 8, 20, 0);
  const Pose goal = at(grid, 50, 20, 0);
  const auto plan = [&](const Pose & from, const Pose & to) {return [&] {(void)planner.plan(grid, from, to);};};
  const Pose outside{0, 0, 0};
  const Pose in_wall = at(grid, 26.5, 10, 0);
  CHECK(fails_for(NoPlan::Reason::kStartOutside, plan(outside, goal)));
  CHECK(fails_for(NoPlan::Reason::kGoalOutside, plan(start, outside)));
  CHECK(fails_for(NoPlan::Reason::kStartBlocked, plan(in_wall, goal)));
  CHECK(fails_for(NoPlan::Reason::kGoalBlocked, plan(start, in_wall)));
  CHECK(fails_for(NoPlan::Reason::kCancelled, [&] {(void)planner.plan(grid, start, goal, [] {return true;});}));
  CHECK(fails_for(NoPlan::Reason::kMemory, [&] {(void)EnergyPlanner("zhang2018", 1000).plan(grid, start, goal);}));
  for (unsigned y = 0; y < grid.height; y++) {
    grid.cells[y * 60 + 26] = Cell::kOccupied;
  }
  CHECK(fails_for(NoPlan::Reason::kUnreachable, plan(start, goal)));
  grid.resolution = 0.1;
  CHECK(fails_for(NoPlan::Reason::kGrid, plan(start, goal)));
  grid = room(planner.resolution());
  grid.cells.pop_back();
  CHECK(fails_for(NoPlan::Reason::kGrid, plan(start, goal)));
  grid = room(planner.resolution());
  grid.elevation.assign(grid.cells.size(), 40);
  CHECK(fails_for(NoPlan::Reason::kGrid, plan(start, goal)));
  CHECK(error_of<std::invalid_argument>([] {EnergyPlanner("nobody", 1);}).find("nobody") != std::string::npos);
}

// ---- The plugin ----

geometry_msgs::msg::PoseStamped stamped(const Pose & pose, const std::string & frame = "map")
{
  geometry_msgs::msg::PoseStamped message;
  message.header.frame_id = frame;
  message.pose.position.x = pose.x;
  message.pose.position.y = pose.y;
  message.pose.orientation.z = std::sin(pose.heading / 2);
  message.pose.orientation.w = std::cos(pose.heading / 2);
  return message;
}

void plugin_plans_on_a_costmap()
{
  const Grid grid = room(0.2);
  nav2_costmap_2d::Costmap2D costmap(grid.width, grid.height, grid.resolution, grid.origin_x, grid.origin_y);
  for (std::size_t i = 0; i < grid.cells.size(); i++) {
    costmap.costs[i] = grid.cells[i] == Cell::kOccupied ? nav2_costmap_2d::LETHAL_OBSTACLE :
      i % 60 < 8 ? nav2_costmap_2d::INSCRIBED_INFLATED_OBSTACLE : nav2_costmap_2d::FREE_SPACE;
  }
  const auto costmap_ros = std::make_shared<nav2_costmap_2d::Costmap2DROS>(costmap);
  const auto node = std::make_shared<rclcpp_lifecycle::LifecycleNode>();
  const auto plugin = make_plugin();
  plugin->configure(node, "GridBased", std::make_shared<tf2_ros::Buffer>(), costmap_ros);
  plugin->activate();

  const Pose start = at(grid, 6.5, 20.5, kPi / 2);
  const Pose goal = at(grid, 50.5, 20.5, -kPi / 2);
  const auto never = [] {return false;};
  const nav_msgs::msg::Path path = plugin->createPlan(stamped(start), stamped(goal), never);
  EnergyPlanner planner("zhang2018", kMemory);
  const Plan plan = planner.plan(grid, start, goal);
  using Publisher = rclcpp_lifecycle::LifecyclePublisher<std_msgs::msg::Float64>;
  const auto published = [&](const char * topic) {
      return std::any_cast<std::shared_ptr<Publisher>>(node->publishers.at(topic))->published;
    };
  CHECK(path.poses.size() == plan.poses.size() && path.header.frame_id == "map" && path.header.stamp.sec == 7);
  CHECK(path.poses.back().pose.position.x == plan.poses.back().x);
  CHECK(published("GridBased/energy").at(0).data == plan.joules);
  CHECK(published("GridBased/energy_deviation").at(0).data == plan.joules_deviation);

  const auto fails = [&](auto error, const geometry_msgs::msg::PoseStamped & from, bool is_cancelled) {
      return !error_of<decltype(error)>(
        [&] {(void)plugin->createPlan(from, stamped(goal), [&] {return is_cancelled;});}).empty();
    };
  CHECK(fails(nav2_core::StartOutsideMapBounds(""), stamped({0, 0, 0}), false));
  CHECK(fails(nav2_core::StartOccupied(""), stamped(at(grid, 26.5, 10, 0)), false));
  CHECK(fails(nav2_core::PlannerTFError(""), stamped(start, "odom"), false));
  CHECK(fails(nav2_core::PlannerCancelled(""), stamped(start), true));
  for (unsigned y = 0; y < grid.height; y++) {
    costmap.costs[y * 60 + 26] = nav2_costmap_2d::NO_INFORMATION;
  }
  CHECK(fails(nav2_core::NoValidPathCouldBeFound(""), stamped(start), false));

  plugin->deactivate();
  plugin->cleanup();
  node->parameters["Other.robot"] = std::string("nobody");
  CHECK(error_of<nav2_core::PlannerException>(
      [&] {plugin->configure(node, "Other", nullptr, costmap_ros);}).find("Other.robot") == 0);
  node->parameters["Least.memory_kib"] = 0;
  CHECK(!error_of<nav2_core::PlannerException>([&] {plugin->configure(node, "Least", nullptr, costmap_ros);}).empty());
}

}  // namespace

int main()
{
  for (const std::string & robot : EnergyPlanner::robots()) {
    plans_round_a_wall(robot);
  }
  hills_cost_and_are_gone_round();
  what_was_learned_counts();
  nothing_to_do_takes_nothing();
  says_why_there_is_no_plan();
  plugin_plans_on_a_costmap();
  return 0;
}
