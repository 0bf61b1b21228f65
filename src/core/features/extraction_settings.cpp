#include <limits>
#include <locale>
#include <sstream>

#include "perennial/core/feature_extractor.h"

namespace perennial {
namespace {

/// The shortest decimal text that reads back as the same number.
std::string exactText(double value) {
  std::string text;
  for (int digits = 1; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
    std::stringstream stream;
    stream.imbue(std::locale::classic());
    stream.precision(digits);
    stream << value;
    text = stream.str();
    double read = 0.0;
    stream >> read;
    if (read == value) {
      break;
    }
  }
  return text;
}

}  // namespace

const char* nameOf(DescriptorKind kind) {
  return kind == DescriptorKind::kOrientation ? "orientation" : "intensity";
}

std::optional<DescriptorKind> descriptorKind(const std::string& name) {
  for (const auto kind : {DescriptorKind::kIntensity, DescriptorKind::kOrientation}) {
    if (name == nameOf(kind)) {
      return kind;
    }
  }
  return std::nullopt;
}

ExtractionSettings ExtractionSettings::load(ParameterReader& reader) {
  ExtractionSettings settings;
  settings.features = reader.integer("features", settings.features, 1, 10000);
  settings.octaves = reader.integer("octaves", settings.octaves, 1, 6);
  settings.layers = reader.integer("layers", settings.layers, 1, 6);
  settings.min_response = reader.real("min_response", settings.min_response, 0.0, 1.0);
  settings.half_resolution = reader.boolean("half_resolution", settings.half_resolution);
  settings.bucket_columns = reader.integer("bucket_columns", settings.bucket_columns, 1, 100);
  settings.bucket_rows = reader.integer("bucket_rows", settings.bucket_rows, 1, 100);
  const std::string descriptor =
      reader.choice("descriptor", nameOf(settings.descriptor),
                    {nameOf(DescriptorKind::kIntensity), nameOf(DescriptorKind::kOrientation)});
  settings.descriptor = descriptorKind(descriptor).value_or(settings.descriptor);
  return settings;
}

std::string ExtractionSettings::describe() const {
  std::string text = "surf-brief/1 features=" + std::to_string(features) +
                     " octaves=" + std::to_string(octaves) + " layers=" + std::to_string(layers) +
                     " min_response=" + exactText(min_response);
  if (half_resolution) {
    text += " half_resolution=1";
  }
  if (bucket_columns * bucket_rows > 1) {
    text += " buckets=" + std::to_string(bucket_columns) + "x" + std::to_string(bucket_rows);
  }
  return text + " descriptor=" + nameOf(descriptor);
}

}  // namespace perennial
