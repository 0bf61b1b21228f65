// Any file is opened, verified and read, or refused. The pages get right checksums first: without them nearly
// every input would end at the first page, and SQLite and the rows' own checks would see nothing.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/map/checksum_vfs.h"
#include "perennial/core/error.h"
#include "perennial/core/map_file.h"

namespace {

/// One for the whole run, removed at its end.
class TemporaryFile {
 public:
  TemporaryFile() : name_("/tmp/perennial_fuzz_XXXXXX") { ::close(mkstemp(name_.data())); }
  ~TemporaryFile() { std::remove(name_.c_str()); }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};

void write(const std::string& file, const std::vector<std::uint8_t>& bytes) {
  FILE* stream = std::fopen(file.c_str(), "wb");
  if (stream == nullptr || std::fwrite(bytes.data(), 1, bytes.size(), stream) != bytes.size()) {
    std::abort();
  }
  std::fclose(stream);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  for (std::size_t page = 0; (page + 1) * perennial::kPageSize <= bytes.size(); ++page) {
    perennial::sealPage(bytes.data() + page * perennial::kPageSize, static_cast<std::uint32_t>(page + 1));
  }
  static const TemporaryFile file;
  write(file.name(), bytes);
  try {
    const perennial::MapFile map(file.name());
    map.verify();
    map.traversals();
    map.read(map.nearest(1.0).index);
  } catch (const perennial::MapError&) {
    // refused, as it should be
  }
  return 0;
}
