#pragma once
#include <mutex>
#include <string>
#include <vector>

namespace nav2_costmap_2d
{
class Costmap2D
{
public:
  using mutex_t = std::recursive_mutex;

  Costmap2D(unsigned width, unsigned height, double resolution, double x, double y)
  : costs(static_cast<std::size_t>(width) * height), width_(width), height_(height), resolution_(resolution), x_(x), y_(y)
  {
  }
  unsigned getSizeInCellsX() const {return width_;}
  unsigned getSizeInCellsY() const {return height_;}
  double getResolution() const {return resolution_;}
  double getOriginX() const {return x_;}
  double getOriginY() const {return y_;}
  unsigned char * getCharMap() const {return const_cast<unsigned char *>(costs.data());}
  mutex_t * getMutex() {return &mutex_;}

  std::vector<unsigned char> costs;

private:
  mutex_t mutex_;
  unsigned width_, height_;
  double resolution_, x_, y_;
};

class Costmap2DROS
{
public:
  explicit Costmap2DROS(Costmap2D & costmap) : costmap_(costmap) {}
  Costmap2D * getCostmap() {return &costmap_;}
  std::string getGlobalFrameID() const {return "map";}

private:
  Costmap2D & costmap_;
};
}  // namespace nav2_costmap_2d
