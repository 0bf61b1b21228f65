#include "core/map/kept_map.h"

#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/map/checksum_vfs.h"
#include "core/map/publish_file.h"

namespace perennial {
namespace {

namespace fs = std::filesystem;

/// Calls `use(page)` for each page of the file; stops when it returns false. Through SQLite's own handle:
/// closing another one would drop the locks that this process holds on the file.
template <typename Use>
void forEachPage(const Database& source, Use use) {
  sqlite3_file* file = nullptr;
  sqlite3_file_control(source.handle(), "main", SQLITE_FCNTL_FILE_POINTER, &file);
  sqlite3_int64 size = 0;
  file->pMethods->xFileSize(file, &size);
  Page page{};
  for (sqlite3_int64 at = 0; at < size; at += static_cast<sqlite3_int64>(page.size())) {
    if (file->pMethods->xRead(file, page.data(), static_cast<int>(page.size()), at) != SQLITE_OK) {
      throw MapError("map '" + source.file() + "' cannot be read: `map_tool verify` lists all damage");
    }
    if (!use(page)) {
      return;
    }
  }
}

bool hasSameContent(const Database& source, const std::string& kept) {
  std::ifstream stream(kept, std::ios::binary);
  bool same = true;
  forEachPage(source, [&](const Page& page) {
    Page other{};
    stream.read(reinterpret_cast<char*>(other.data()), static_cast<std::streamsize>(other.size()));
    same = stream.gcount() == static_cast<std::streamsize>(page.size()) && page == other;
    return same;
  });
  return same && stream.peek() == std::ifstream::traits_type::eof();
}

void copyTo(const std::string& kept, const Database& source) {
  PartialFile copy(kept, PartialFile::Content::kCopy);
  forEachPage(source, [&copy](const Page& page) {
    copy.append(page.data(), page.size());
    return true;
  });
  copy.publish(false);
}

}  // namespace

bool keepMapAs(const Database& source, const std::string& kept) {
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(kept, ignored))) {
    if (fs::equivalent(source.file(), kept, ignored) || hasSameContent(source, kept)) {
      return false;
    }
    throw MapError("the original would be kept as '" + kept +
                   "', but there is another file of that name: move or remove that first");
  }
  if (::link(source.file().c_str(), kept.c_str()) == 0) {
    syncFolder(kept);
  } else {
    copyTo(kept, source);
  }
  return true;
}

}  // namespace perennial
