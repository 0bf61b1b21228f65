#include <locale>
#include <sstream>

#include "perennial/core/feature_extractor.h"

namespace perennial {

ExtractionSettings ExtractionSettings::load(ParameterReader& reader) {
  ExtractionSettings settings;
  settings.features = reader.integer("features", settings.features, 1, 10000);
  settings.octaves = reader.integer("octaves", settings.octaves, 1, 6);
  settings.layers = reader.integer("layers", settings.layers, 1, 6);
  settings.min_response = reader.real("min_response", settings.min_response, 0.0, 1.0);
  return settings;
}

std::string ExtractionSettings::describe() const {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(17);  // every double has a text of its own
  text << "surf-brief/1 features=" << features << " octaves=" << octaves << " layers=" << layers
       << " min_response=" << min_response;
  return text.str();
}

}  // namespace perennial
