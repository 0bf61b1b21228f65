#include "perennial/ros/reconfigure.h"

namespace perennial {

void toConfig(const ExtractionSettings& settings, perennial_nav::ExtractionConfig& config) {
  config.features = settings.features;
  config.octaves = settings.octaves;
  config.layers = settings.layers;
  config.min_response = settings.min_response;
  config.half_resolution = settings.half_resolution;
  config.bucket_columns = settings.bucket_columns;
  config.bucket_rows = settings.bucket_rows;
  config.descriptor = nameOf(settings.descriptor);
}

void toConfig(const RegistrationSettings& settings, perennial_nav::RegistrationConfig& config) {
  config.method = nameOf(settings.method);
  config.ratio = settings.ratio;
  config.max_vertical_px = settings.max_vertical_px;
  config.bin_width_px = settings.bin_width_px;
  config.min_inliers = settings.min_inliers;
  config.min_confidence = settings.min_confidence;
}

void toConfig(const SteeringSettings& settings, perennial_nav::SteeringConfig& config) {
  config.gain_per_rad = settings.gain_per_rad;
  config.gain_per_px = settings.gain_per_px;
  config.max_correction = settings.max_correction;
}

ExtractionSettings fromConfig(const perennial_nav::ExtractionConfig& config) {
  ExtractionSettings settings;
  settings.features = config.features;
  settings.octaves = config.octaves;
  settings.layers = config.layers;
  settings.min_response = config.min_response;
  settings.half_resolution = config.half_resolution;
  settings.bucket_columns = config.bucket_columns;
  settings.bucket_rows = config.bucket_rows;
  settings.descriptor = descriptorKind(config.descriptor).value_or(settings.descriptor);
  return settings;
}

RegistrationSettings fromConfig(const perennial_nav::RegistrationConfig& config) {
  RegistrationSettings settings;
  settings.method = registrationMethod(config.method).value_or(settings.method);
  settings.ratio = config.ratio;
  settings.max_vertical_px = config.max_vertical_px;
  settings.bin_width_px = config.bin_width_px;
  settings.min_inliers = config.min_inliers;
  settings.min_confidence = config.min_confidence;
  return settings;
}

SteeringSettings fromConfig(const perennial_nav::SteeringConfig& config) {
  SteeringSettings settings;
  settings.gain_per_rad = config.gain_per_rad;
  settings.gain_per_px = config.gain_per_px;
  settings.max_correction = config.max_correction;
  return settings;
}

}  // namespace perennial
