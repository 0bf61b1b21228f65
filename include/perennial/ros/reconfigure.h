#pragma once

#include <cstdint>

#include "perennial/core/feature_extractor.h"
#include "perennial/core/registration.h"
#include "perennial/core/steering.h"
#include "perennial_nav/ExtractionConfig.h"
#include "perennial_nav/RegistrationConfig.h"
#include "perennial_nav/SteeringConfig.h"

/// Between the settings of the core and dynamic_reconfigure. A node loads its settings strictly, then puts
/// them into the configuration that dynamic_reconfigure announces.
namespace perennial {

/// The level with which dynamic_reconfigure calls back at start-up.
constexpr std::uint32_t kFirstReconfigure = ~std::uint32_t{0};

void toConfig(const ExtractionSettings& settings, perennial_nav::ExtractionConfig& config);
void toConfig(const RegistrationSettings& settings, perennial_nav::RegistrationConfig& config);
void toConfig(const SteeringSettings& settings, perennial_nav::SteeringConfig& config);

ExtractionSettings fromConfig(const perennial_nav::ExtractionConfig& config);
RegistrationSettings fromConfig(const perennial_nav::RegistrationConfig& config);
SteeringSettings fromConfig(const perennial_nav::SteeringConfig& config);

}  // namespace perennial
