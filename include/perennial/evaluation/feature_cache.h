#pragma once

#include <memory>
#include <optional>
#include <string>

#include "perennial/core/feature.h"

namespace perennial {

/// Features of an image, and what it took to extract them.
struct CachedFeatures {
  std::shared_ptr<const FeatureSet> features;
  int image_width = 0;
  int image_height = 0;
  double extraction_ms = 0.0;  ///< when they were extracted, perhaps on another day
};

/// Keeps extracted features on disk, one file per image and extraction settings, known by the image's
/// content: a copy of a data set needs no extraction, a changed image is extracted again. Files are written
/// whole or not at all, so that several programs may share a folder; a damaged one counts as missing. Safe to
/// use from several threads.
class FeatureCache {
 public:
  /// Creates the folder. Throws Error when that fails.
  explicit FeatureCache(std::string folder);

  /// `image`: content of the image file. `extraction`: ExtractionSettings::describe().
  std::optional<CachedFeatures> find(const std::string& image, const std::string& extraction) const;
  /// Throws Error when the folder cannot be written.
  void store(const std::string& image, const std::string& extraction, const CachedFeatures& features) const;

  const std::string& folder() const { return folder_; }

 private:
  std::string fileFor(const std::string& image, const std::string& extraction) const;

  std::string folder_;
};

/// $XDG_CACHE_HOME/perennial_nav/features, or the like in the home folder.
std::string defaultCacheFolder();

}  // namespace perennial
