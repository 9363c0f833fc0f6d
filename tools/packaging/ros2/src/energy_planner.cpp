#include "joulepath_nav2/energy_planner.hpp"

#include <cmath>

#include <joulepath/lattice_path.h>
#include <joulepath/planner.h>
#include <joulepath/skid_path_energy.h>
#include <joulepath/tables.h>

namespace joulepath_nav2
{
namespace
{

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadians = 2 * kPi / 4294967296.0;  // of a jp_angle
constexpr double kQ16 = 65536.0;
constexpr double kQ24 = 16777216.0;
constexpr unsigned kSlice = 1000;       // expansions
constexpr std::uint16_t kPieces = 4096;  // of a path

struct Robot
{
  const char * name;
  const jp_lattice * lattice;
  const jp_skid_energy_model * energy;
  const jp_skid_learning * learning;
  const jp_path_limits * limits;
};

const Robot kRobots[] = {
  {"burger", &jp_lattice_burger, &jp_skid_energy_burger, &jp_skid_learning_burger, &jp_path_limits_burger},
  {"zhang2018", &jp_lattice_zhang2018, &jp_skid_energy_zhang2018, &jp_skid_learning_zhang2018,
    &jp_path_limits_zhang2018},
};

const Robot & find_robot(const std::string & name)
{
  for (const Robot & robot : kRobots) {
    if (name == robot.name) {
      return robot;
    }
  }
  throw std::invalid_argument("robot: no tables of " + name + " are built in; build them in, or choose another robot");
}

/// Memory of the library, aligned for it.
std::vector<std::uint64_t> block_of(std::size_t bytes)
{
  return std::vector<std::uint64_t>((bytes + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t));
}

unsigned nearest_heading(const jp_lattice & lattice, double heading)
{
  unsigned nearest = 0;
  double least = 2 * kPi;
  for (unsigned i = 0; i < JP_HEADINGS; i++) {
    const double off = std::abs(std::remainder(heading - lattice.heading[i] * kRadians, 2 * kPi));
    if (off < least) {
      least = off;
      nearest = i;
    }
  }
  return nearest;
}

/// A map in the library's memory.
class Map
{
public:
  explicit Map(const Grid & grid)
  : grid_(grid)
  {
    check();
    jp_terrain_config config{};
    config.width = static_cast<std::uint16_t>(grid.width);
    config.height = static_cast<std::uint16_t>(grid.height);
    config.resolution = static_cast<jp_q16>(std::lround(grid.resolution * kQ16));
    config.has_elevation = !grid.elevation.empty();
    config.unknown_is_free = grid.unknown_is_free;
    const std::size_t size = jp_terrain_size(&config);
    block_ = block_of(size);
    const char * field = "size";
    if (jp_terrain_init(&terrain_, &config, block_.data(), size, &field) != JP_OK) {
      throw NoPlan(NoPlan::Reason::kGrid, std::string("grid: ") + field + " is out of range");
    }
    fill();
  }

  jp_terrain & terrain() {return terrain_;}

  bool cell_of(const Pose & pose, jp_lattice_pose & cell) const
  {
    const double x = std::floor((pose.x - grid_.origin_x) / grid_.resolution);
    const double y = std::floor((pose.y - grid_.origin_y) / grid_.resolution);
    if (!(x >= 0 && x < grid_.width && y >= 0 && y < grid_.height)) {
      return false;
    }
    cell.x = static_cast<std::int16_t>(x);
    cell.y = static_cast<std::int16_t>(y);
    return true;
  }

private:
  void check() const
  {
    const std::size_t count = static_cast<std::size_t>(grid_.width) * grid_.height;
    if (grid_.width > JP_TERRAIN_SIDE_MAX || grid_.height > JP_TERRAIN_SIDE_MAX || grid_.cells.size() != count ||
      (!grid_.elevation.empty() && grid_.elevation.size() != count))
    {
      throw NoPlan(NoPlan::Reason::kGrid, "grid: its arrays do not have width × height cells, or it is too large");
    }
  }

  void fill()
  {
    std::size_t i = 0;
    for (unsigned y = 0; y < grid_.height; y++) {
      for (unsigned x = 0; x < grid_.width; x++, i++) {
        const auto column = static_cast<std::int32_t>(x);
        const auto row = static_cast<std::int32_t>(y);
        (void)jp_terrain_set_cell(&terrain_, column, row, static_cast<jp_cell>(grid_.cells[i]));
        if (!grid_.elevation.empty()) {
          set_elevation(column, row, static_cast<double>(grid_.elevation[i]));
        }
      }
    }
  }

  void set_elevation(std::int32_t x, std::int32_t y, double elevation)
  {
    const double units = std::round(elevation * JP_ELEVATION_ONE);
    if (!(std::abs(units) <= INT16_MAX)) {
      throw NoPlan(NoPlan::Reason::kGrid, "grid: an elevation is not within 31.999 m of its datum; shift the datum");
    }
    (void)jp_terrain_set_elevation(&terrain_, x, y, static_cast<jp_elevation>(units));
  }

  const Grid & grid_;
  std::vector<std::uint64_t> block_;
  jp_terrain terrain_{};
};

/// Poses of a piece every `step` m, its end left out: the curvature is linear in the arc length.
void sample(const jp_path_piece & piece, double step, const Grid & grid, std::vector<Pose> & poses)
{
  Pose pose{piece.begin.x / kQ16 + grid.origin_x, piece.begin.y / kQ16 + grid.origin_y,
    piece.heading * kRadians};
  poses.push_back(pose);
  if (piece.kind != JP_PIECE_CURVE) {
    return;
  }
  const double length = piece.length / kQ24;
  const double bend = piece.bend / kQ24;
  const double bend_rate = piece.bend_rate / kQ16;
  const double begin = pose.heading;
  const int count = static_cast<int>(std::ceil(length / step));
  const double part = length / count;
  const auto heading = [&](double way) {return begin + (bend + bend_rate * way / 2) * way;};
  for (int i = 1; i < count; i++) {
    const double from = (i - 1) * part;
    const double angles[] = {heading(from), heading(from + part / 2), heading(from + part)};
    // Simpson's rule.
    pose.x += part / 6 * (std::cos(angles[0]) + 4 * std::cos(angles[1]) + std::cos(angles[2]));
    pose.y += part / 6 * (std::sin(angles[0]) + 4 * std::sin(angles[1]) + std::sin(angles[2]));
    pose.heading = angles[2];
    poses.push_back(pose);
  }
}

}  // namespace

class EnergyPlanner::Implementation
{
public:
  Implementation(const std::string & name, std::size_t memory)
  : robot_(find_robot(name)), block_(block_of(memory)), pieces_(kPieces)
  {
    jp_skid_learner_start(&learner_, robot_.learning, robot_.energy);
  }

  double resolution() const {return robot_.lattice->resolution / kQ16;}

  void restore(const jp_learned_state & state)
  {
    const char * field = "";
    if (jp_skid_learner_restore(&learner_, &state, &field) != JP_OK) {
      throw std::invalid_argument(std::string("learned state: ") + field + " does not fit " + robot_.name);
    }
  }

  Plan plan(const Grid & grid, const Pose & start, const Pose & goal, const std::function<bool()> & is_cancelled)
  {
    if (std::abs(grid.resolution - resolution()) > 0.5 / kQ16) {
      throw NoPlan(
              NoPlan::Reason::kGrid, "grid: its cells are not those of the robot's lattice, of " +
              std::to_string(resolution()) + " m; set the costmap's resolution to it");
    }
    Map map(grid);
    jp_planner planner;
    begin(planner, map, start, goal);
    search(planner, is_cancelled);
    return result(planner, grid, start, goal);
  }

private:
  static void accept(jp_status status, NoPlan::Reason reason, const char * what)
  {
    if (status != JP_OK) {
      throw NoPlan(reason, std::string(what) + ": the robot does not fit there");
    }
  }

  void begin(jp_planner & planner, Map & map, const Pose & start, const Pose & goal)
  {
    jp_planner_config config{};
    config.lattice = robot_.lattice;
    config.cost = JP_COST_PHYSICAL;
    config.epsilon[0] = JP_EPSILON(2);
    config.epsilon[1] = JP_EPSILON_ONE;
    const char * field = "memory";
    if (jp_planner_init(
        &planner, &config, &map.terrain(), block_.data(), block_.size() * sizeof block_[0], &field) != JP_OK)
    {
      throw NoPlan(
              NoPlan::Reason::kMemory, "memory: too little for this map, which needs " +
              std::to_string(jp_planner_size(&map.terrain().config)) + " B");
    }
    jp_lattice_pose from{};
    jp_lattice_pose to{};
    if (!map.cell_of(start, from)) {
      throw NoPlan(NoPlan::Reason::kStartOutside, "start: outside the map");
    }
    if (!map.cell_of(goal, to)) {
      throw NoPlan(NoPlan::Reason::kGoalOutside, "goal: outside the map");
    }
    from.heading = static_cast<std::uint8_t>(nearest_heading(*robot_.lattice, start.heading));
    const jp_goal target{to.x, to.y, static_cast<std::uint16_t>(1U << nearest_heading(*robot_.lattice, goal.heading))};
    accept(jp_planner_set_start(&planner, &from), NoPlan::Reason::kStartBlocked, "start");
    accept(jp_planner_set_goal(&planner, &target), NoPlan::Reason::kGoalBlocked, "goal");
  }

  static void search(jp_planner & planner, const std::function<bool()> & is_cancelled)
  {
    jp_answer answer = JP_ANSWER_OUT_OF_BUDGET;
    while (!jp_planner_is_idle(&planner)) {
      if (is_cancelled()) {
        throw NoPlan(NoPlan::Reason::kCancelled, "cancelled");
      }
      answer = jp_planner_work(&planner, kSlice);
    }
    if (answer == JP_ANSWER_UNREACHABLE) {
      throw NoPlan(NoPlan::Reason::kUnreachable, "goal: no way leads there");
    }
    if (answer != JP_ANSWER_OPTIMAL && answer != JP_ANSWER_WITHIN_BOUND) {
      throw NoPlan(NoPlan::Reason::kMemory, "memory: too little to find the way to this goal; give more");
    }
  }

  Plan result(const jp_planner & planner, const Grid & grid, const Pose & start, const Pose & goal)
  {
    Plan plan;
    plan.is_optimal = jp_planner_plan(&planner)->answer == JP_ANSWER_OPTIMAL;
    if (jp_planner_plan(&planner)->step_count == 0) {
      plan.poses = {start, goal};
      return plan;
    }
    jp_lattice_path path{};
    if (jp_lattice_path_of_plan(&path, &planner, pieces_.data(), kPieces) != JP_OK) {
      throw NoPlan(NoPlan::Reason::kMemory, "path: it has more pieces than there is room for; give a nearer goal");
    }
    forecast(path, plan);
    for (std::uint16_t i = 0; i < path.count; i++) {
      plan.metres += pieces_[i].kind == JP_PIECE_CURVE ? pieces_[i].length / kQ24 : 0;
      sample(pieces_[i], grid.resolution, grid, plan.poses);
    }
    plan.poses.push_back(
      {path.end.position.x / kQ16 + grid.origin_x, path.end.position.y / kQ16 + grid.origin_y,
        path.end.heading * kRadians});
    return plan;
  }

  void forecast(jp_lattice_path & path, Plan & plan)
  {
    const jp_motion_price price = jp_skid_motion_price(&learner_.model, 0);
    jp_path_cost cost{};
    (void)jp_path_plan_speeds(&path, robot_.limits, &price, &cost);
    jp_skid_drive drive{};
    jp_q16 duration = 0;
    jp_skid_path_energy(&learner_.model, &path, &drive, &duration);
    jp_forecast_sum sum{};
    jp_forecast total{};
    if (jp_skid_forecast_add(&learner_, &sum, &drive) != JP_OK ||
      jp_skid_forecast_total(&learner_, &sum, &total) != JP_OK)
    {
      throw NoPlan(NoPlan::Reason::kMemory, "forecast: more energy than its format holds; give a nearer goal");
    }
    const double unit = std::ldexp(1.0, robot_.energy->unit_exponent);
    plan.seconds = duration / kQ16;
    plan.joules = total.energy / kQ16 * unit;
    plan.joules_deviation = total.deviation / kQ16 * unit;
  }

  const Robot & robot_;
  std::vector<std::uint64_t> block_;
  std::vector<jp_path_piece> pieces_;
  jp_skid_learner learner_{};
};

EnergyPlanner::EnergyPlanner(const std::string & robot, std::size_t memory)
: implementation_(std::make_unique<Implementation>(robot, memory))
{
}

EnergyPlanner::~EnergyPlanner() = default;

std::vector<std::string> EnergyPlanner::robots()
{
  std::vector<std::string> names;
  for (const Robot & robot : kRobots) {
    names.emplace_back(robot.name);
  }
  return names;
}

double EnergyPlanner::resolution() const
{
  return implementation_->resolution();
}

void EnergyPlanner::restore(const jp_learned_state & state)
{
  implementation_->restore(state);
}

Plan EnergyPlanner::plan(
  const Grid & grid, const Pose & start, const Pose & goal, const std::function<bool()> & is_cancelled)
{
  return implementation_->plan(grid, start, goal, is_cancelled);
}

}  // namespace joulepath_nav2
