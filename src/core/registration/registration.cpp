#include "perennial/core/registration.h"

#include "core/registration/workspace.h"

namespace perennial {

const char* nameOf(RegistrationMethod method) {
  return method == RegistrationMethod::kRobust ? "robust" : "histogram";
}

std::optional<RegistrationMethod> registrationMethod(const std::string& name) {
  for (const auto method : {RegistrationMethod::kHistogram, RegistrationMethod::kRobust}) {
    if (name == nameOf(method)) {
      return method;
    }
  }
  return std::nullopt;
}

RegistrationSettings RegistrationSettings::load(ParameterReader& reader) {
  RegistrationSettings settings;
  const std::string method =
      reader.choice("method", nameOf(settings.method),
                    {nameOf(RegistrationMethod::kHistogram), nameOf(RegistrationMethod::kRobust)});
  settings.method = registrationMethod(method).value_or(settings.method);
  settings.ratio = reader.real("ratio", settings.ratio, 0.0, 1.0);
  settings.max_vertical_px = reader.real("max_vertical_px", settings.max_vertical_px, 0.0, 10000.0);
  settings.bin_width_px = reader.real("bin_width_px", settings.bin_width_px, 0.1, 1000.0);
  settings.min_inliers = reader.integer("min_inliers", settings.min_inliers, 1, 10000);
  settings.min_confidence = reader.real("min_confidence", settings.min_confidence, 0.0, 1.0);
  return settings;
}

RegistrationWorkspace::RegistrationWorkspace() : buffers_(std::make_unique<Buffers>()) {}
RegistrationWorkspace::~RegistrationWorkspace() = default;
RegistrationWorkspace::RegistrationWorkspace(RegistrationWorkspace&&) noexcept = default;
RegistrationWorkspace& RegistrationWorkspace::operator=(RegistrationWorkspace&&) noexcept = default;

RegistrationResult Registration::registerView(const FeatureSet& map, const FeatureSet& view) const {
  RegistrationWorkspace workspace;
  RegistrationResult result;
  registerInto(map, view, workspace, result);
  return result;
}

std::unique_ptr<Registration> makeRegistration(const RegistrationSettings& settings) {
  if (settings.method == RegistrationMethod::kRobust) {
    return std::make_unique<RobustRegistration>(settings);
  }
  return std::make_unique<HistogramRegistration>(settings);
}

}  // namespace perennial
