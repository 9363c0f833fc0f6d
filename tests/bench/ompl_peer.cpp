#include "tests/bench/ompl_peer.h"

#include <cmath>
#include <limits>
#include <memory>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace
{

constexpr unsigned seed = 1;
constexpr double step = 0.5; // cells between two looks at the map

struct Map {
    const jp_lattice *lattice;
    const jp_terrain *terrain;
};

struct Point { // cells
    double x;
    double y;
};

Point point_of(const ob::State *state)
{
    const double *values = state->as<ob::RealVectorStateSpace::StateType>()->values;
    return {values[0], values[1]};
}

bool can_stand(const Map &map, const Point &point, unsigned heading)
{
    return jp_lattice_can_stand(map.lattice, map.terrain, static_cast<int32_t>(std::floor(point.x)),
                                static_cast<int32_t>(std::floor(point.y)), heading);
}

bool can_stand_at_any(const Map &map, const Point &point)
{
    for (unsigned heading = 0; heading < JP_HEADINGS; heading++) {
        if (can_stand(map, point, heading)) {
            return true;
        }
    }
    return false;
}

double radians(jp_angle angle)
{
    return std::ldexp(2 * M_PI * static_cast<double>(angle), -8 * static_cast<int>(sizeof angle));
}

// Of a line, which a robot drives along either way.
unsigned nearest_heading(const jp_lattice &lattice, double direction)
{
    unsigned nearest = 0;
    for (unsigned heading = 1; heading < JP_HEADINGS; heading++) {
        if (std::cos(radians(lattice.heading[heading]) - direction) >
            std::cos(radians(lattice.heading[nearest]) - direction)) {
            nearest = heading;
        }
    }
    return nearest;
}

class StraightDrive : public ob::MotionValidator
{
  public:
    StraightDrive(const ob::SpaceInformationPtr &information, const Map &map)
        : ob::MotionValidator(information), map_(map)
    {
    }

    bool checkMotion(const ob::State *from, const ob::State *to) const override
    {
        return free_part(point_of(from), point_of(to)) >= 1;
    }

    bool checkMotion(const ob::State *from, const ob::State *to,
                     std::pair<ob::State *, double> &last_valid) const override
    {
        const double part = free_part(point_of(from), point_of(to));
        last_valid.second = part;
        if (last_valid.first != nullptr) {
            si_->getStateSpace()->interpolate(from, to, part, last_valid.first);
        }
        return part >= 1;
    }

  private:
    // How far of the way from one point to the other the robot fits.
    double free_part(const Point &from, const Point &to) const
    {
        const double dx = to.x - from.x;
        const double dy = to.y - from.y;
        const unsigned heading = nearest_heading(*map_.lattice, std::atan2(dy, dx));
        const int steps = static_cast<int>(std::ceil(std::hypot(dx, dy) / step));

        for (int i = 0; i <= steps; i++) {
            const double part = steps == 0 ? 0 : static_cast<double>(i) / steps;
            if (!can_stand(map_, {from.x + part * dx, from.y + part * dy}, heading)) {
                return i == 0 ? 0 : static_cast<double>(i - 1) / steps;
            }
        }
        return 1;
    }

    Map map_;
};

ob::SpaceInformationPtr space_of(const Map &map)
{
    const auto space = std::make_shared<ob::RealVectorStateSpace>(2);
    ob::RealVectorBounds bounds(2);
    bounds.setLow(0);
    bounds.setHigh(0, map.terrain->config.width - 1e-6);
    bounds.setHigh(1, map.terrain->config.height - 1e-6);
    space->setBounds(bounds);

    const auto information = std::make_shared<ob::SpaceInformation>(space);
    information->setStateValidityChecker(
        [map](const ob::State *state) { return can_stand_at_any(map, point_of(state)); });
    information->setMotionValidator(std::make_shared<StraightDrive>(information, map));
    information->setup();
    return information;
}

ob::ProblemDefinitionPtr problem_of(const ob::SpaceInformationPtr &information, const jp_lattice_pose &start,
                                    const jp_goal &goal)
{
    const auto problem = std::make_shared<ob::ProblemDefinition>(information);
    ob::ScopedState<ob::RealVectorStateSpace> from(information);
    ob::ScopedState<ob::RealVectorStateSpace> to(information);
    from[0] = start.x + 0.5;
    from[1] = start.y + 0.5;
    to[0] = goal.x + 0.5;
    to[1] = goal.y + 0.5;
    problem->setStartAndGoalStates(from, to);
    problem->setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(information));
    return problem;
}

ob::PlannerPtr planner_of(ompl_planner planner, const ob::SpaceInformationPtr &information)
{
    if (planner == OMPL_RRT_STAR) {
        return std::make_shared<og::RRTstar>(information);
    }
    return std::make_shared<og::BITstar>(information);
}

void be_quiet_and_repeatable()
{
    static const bool is_done = [] {
        ompl::msg::noOutputHandler();
        ompl::RNG::setSeed(seed);
        return true;
    }();
    (void)is_done;
}

} // namespace

double ompl_length(ompl_planner planner, const jp_lattice *lattice, const jp_terrain *terrain,
                   const jp_lattice_pose *start, const jp_goal *goal, double seconds)
{
    be_quiet_and_repeatable();
    const ob::SpaceInformationPtr information = space_of({lattice, terrain});
    const ob::ProblemDefinitionPtr problem = problem_of(information, *start, *goal);
    const ob::PlannerPtr peer = planner_of(planner, information);

    peer->setProblemDefinition(problem);
    peer->setup();
    peer->solve(seconds);
    return problem->hasExactSolution() ? std::ldexp(problem->getSolutionPath()->length() * lattice->resolution, -16)
                                       : std::numeric_limits<double>::infinity();
}
