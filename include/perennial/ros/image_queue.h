#pragma once

#include <sensor_msgs/Image.h>

#include <cstddef>
#include <deque>

namespace perennial {

/// Images, in order, that wait until the odometry and the local map for their stamp have come. When it is
/// full the oldest is dropped; capacity 0 keeps all, as a bag wants it.
class ImageQueue {
 public:
  explicit ImageQueue(std::size_t capacity) : capacity_(capacity) {}

  void push(const sensor_msgs::ImageConstPtr& image) {
    if (capacity_ > 0 && images_.size() >= capacity_) {
      drop();
    }
    images_.push_back(image);
  }
  bool empty() const { return images_.empty(); }
  const sensor_msgs::ImageConstPtr& front() const { return images_.front(); }
  const sensor_msgs::ImageConstPtr& second() const { return images_[1]; }
  std::size_t size() const { return images_.size(); }
  /// Removes the first one, used.
  void pop() { images_.pop_front(); }
  /// Removes the first one, unused.
  void drop() {
    images_.pop_front();
    ++dropped_;
  }
  void clear() { images_.clear(); }
  std::size_t dropped() const { return dropped_; }

 private:
  std::size_t capacity_;
  std::size_t dropped_ = 0;
  std::deque<sensor_msgs::ImageConstPtr> images_;
};

}  // namespace perennial
