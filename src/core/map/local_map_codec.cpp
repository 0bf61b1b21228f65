#include "core/map/local_map_codec.h"

#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>

#include "core/map/row_checksum.h"
#include "perennial/core/error.h"

namespace perennial {
namespace {

static_assert(sizeof(Keypoint) == 16 && std::is_trivially_copyable<Keypoint>::value, "four float32");
static_assert(sizeof(Descriptor) == 32 && std::is_trivially_copyable<Descriptor>::value, "four uint64");

constexpr std::size_t kBytesPerFeature = sizeof(Keypoint) + sizeof(Descriptor) + sizeof(std::uint32_t);

class Writer {
 public:
  template <typename T>
  void put(const T& value) {
    putArray(&value, 1);
  }
  template <typename T>
  void putArray(const T* values, std::size_t count) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(values);
    bytes_.insert(bytes_.end(), begin, begin + count * sizeof(T));
  }
  void reserve(std::size_t size) { bytes_.reserve(size); }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

class Reader {
 public:
  explicit Reader(const Bytes& bytes) : bytes_(bytes) {}

  template <typename T>
  T get() {
    require(1, sizeof(T));
    T value;
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }
  template <typename T>
  std::vector<T> getArray(std::size_t count) {
    require(count, sizeof(T));
    std::vector<T> values(count);
    if (count > 0) {
      std::memcpy(values.data(), bytes_.data() + position_, count * sizeof(T));
    }
    position_ += count * sizeof(T);
    return values;
  }
  /// Before anything is allocated: a damaged count must not ask for more memory than the blob has bytes.
  void require(std::size_t count, std::size_t size) const {
    if (count > (bytes_.size() - position_) / size) {
      throw MapError("it ends too early");
    }
  }
  bool atEnd() const { return position_ == bytes_.size(); }

 private:
  const Bytes& bytes_;
  std::size_t position_ = 0;
};

}  // namespace

Bytes encodeLocalMap(const LocalMap& map) {
  Writer writer;
  writer.reserve(64 + map.size() * (kBytesPerFeature + map.numbers_per_feature * sizeof(double)));
  writer.put(map.index);
  writer.put(map.next_id);
  writer.put(map.distance_m);
  writer.put(map.stamp_s);
  writer.put(static_cast<std::uint32_t>(map.size()));
  writer.put(static_cast<std::uint32_t>(map.numbers_per_feature));
  writer.put(static_cast<std::uint32_t>(map.map_numbers.size()));
  writer.put(static_cast<std::uint32_t>(map.strategy.size()));
  writer.putArray(map.strategy.data(), map.strategy.size());
  writer.putArray(map.features.keypoints.data(), map.size());
  writer.putArray(map.features.descriptors.data(), map.size());
  writer.putArray(map.ids.data(), map.size());
  writer.putArray(map.numbers.data(), map.numbers.size());
  writer.putArray(map.map_numbers.data(), map.map_numbers.size());
  return writer.take();
}

LocalMap decodeLocalMap(const Bytes& bytes) {
  Reader reader(bytes);
  LocalMap map;
  map.index = reader.get<std::uint32_t>();
  map.next_id = reader.get<std::uint32_t>();
  map.distance_m = reader.get<double>();
  map.stamp_s = reader.get<double>();
  const std::size_t features = reader.get<std::uint32_t>();
  map.numbers_per_feature = reader.get<std::uint32_t>();
  const std::size_t map_numbers = reader.get<std::uint32_t>();
  const std::size_t name_length = reader.get<std::uint32_t>();
  const std::vector<char> name = reader.getArray<char>(name_length);
  map.strategy.assign(name.begin(), name.end());
  map.features.keypoints = reader.getArray<Keypoint>(features);
  map.features.descriptors = reader.getArray<Descriptor>(features);
  map.ids = reader.getArray<std::uint32_t>(features);
  map.numbers = reader.getArray<double>(features * map.numbers_per_feature);
  map.map_numbers = reader.getArray<double>(map_numbers);
  if (!reader.atEnd()) {
    throw MapError("it is longer than its features");
  }
  const std::string problem = map.problem();
  if (!problem.empty()) {
    throw MapError(problem);
  }
  return map;
}

}  // namespace perennial
