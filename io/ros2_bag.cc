// ROS 2 bags in SQLite.
#ifdef SCANCAL_SQLITE
#include <sqlite3.h>
#include <algorithm>
#include <map>
#include <utility>
#include "io/message.h"
#endif
#include "io/decoded_file.h"
#include "io/ros.h"

namespace scancal {

#ifdef SCANCAL_SQLITE

namespace {

using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

class Ros2Bag : public RosBag {
 public:
  explicit Ros2Bag(std::filesystem::path path, int64_t size) : path_(std::move(path)), size_(size) {}
  std::vector<RosTopic> topics() const override { return topics_; }
  int64_t bytes_read() const override { return read_; }
  int64_t bytes_total() const override { return size_; }

  Result<void> Open() {
    sqlite3* opened = nullptr;
    const int state = sqlite3_open_v2(Uri().c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(opened);
    if (state != SQLITE_OK) return Damaged();
    // A schema is a program: it gets no more time and memory than a bag of this size needs.
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_limit(database_.get(), SQLITE_LIMIT_LENGTH, static_cast<int>(std::min<int64_t>(size_ + 4096, 1 << 30)));
    constexpr int kOperations = 100'000;
    pieces_ = 100 + size_ / kOperations * 10;
    sqlite3_progress_handler(
        database_.get(), kOperations, [](void* bag) { return --static_cast<Ros2Bag*>(bag)->pieces_ < 0 ? 1 : 0; },
        this);
    SCANCAL_RETURN_IF_ERROR(Prepare(
        "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages') AND sql NOT LIKE "
        "'create virtual%'"));
    SCANCAL_ASSIGN_OR_RETURN(const bool any, Step());
    if (!any || sqlite3_column_int(statement_.get(), 0) != 2)
      return Error{path_.string() +
                   ": found a database of SQLite without the tables topics and messages, expected a "
                   "ROS 2 bag"};
    return ReadTopics();
  }

  Result<bool> Next(RosMessage* message) override {
    if (at_end_) return false;  // another step would begin again
    SCANCAL_ASSIGN_OR_RETURN(const bool more, Step());
    if (!more) {
      read_ = size_;
      at_end_ = true;
      return false;
    }
    const auto topic = wanted_.find(sqlite3_column_int64(statement_.get(), 0));
    if (topic == wanted_.end()) return Error{path_.string() + ": found a message without its topic"};
    const auto* const data = static_cast<const char*>(sqlite3_column_blob(statement_.get(), 1));
    const auto size = static_cast<size_t>(sqlite3_column_bytes(statement_.get(), 1));
    read_ = std::min(size_, read_ + static_cast<int64_t>(size));
    *message = {topic->second, data == nullptr ? std::string_view() : std::string_view(data, size), true};
    if (message->data.starts_with("\x28\xb5\x2f\xfd"))
      return Error{path_.string() +
                   ": found messages packed as zstd, expected them as they are; ros2 bag convert "
                   "writes them without"};
    return true;
  }

 private:
  // Without its lock files, which the folder may not take, unless what was written last is in one.
  std::string Uri() const {
    std::string uri = "file:";
    for (const char c : path_.string()) {
      constexpr char kDigits[] = "0123456789abcdef";
      const auto byte = static_cast<unsigned char>(c);
      if (c == '?' || c == '#' || c == '%') uri += {'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
      else uri += c;
    }
    std::error_code ignored;
    const auto log = std::filesystem::file_size(path_.string() + "-wal", ignored);
    return uri + (ignored || log == 0 ? "?immutable=1" : "");
  }

  Error Damaged() const {
    const bool stopped = pieces_ < 0;
    return {path_.string() + ": cannot be read as a ROS 2 bag: " +
            (stopped ? "it takes too long for its size" : sqlite3_errmsg(database_.get()))};
  }

  Result<void> Prepare(const std::string& query) {
    sqlite3_stmt* prepared = nullptr;
    const int state = sqlite3_prepare_v2(database_.get(), query.c_str(), -1, &prepared, nullptr);
    statement_.reset(prepared);
    if (state != SQLITE_OK) return Damaged();
    return {};
  }

  Result<bool> Step() {
    const int state = sqlite3_step(statement_.get());
    if (state != SQLITE_ROW && state != SQLITE_DONE) return Damaged();
    return state == SQLITE_ROW;
  }

  std::string Text(int column) const {
    const auto* const text = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
    return text == nullptr ? ""
                           : std::string(text, static_cast<size_t>(sqlite3_column_bytes(statement_.get(), column)));
  }

  Result<void> ReadTopics() {
    SCANCAL_RETURN_IF_ERROR(Prepare("SELECT id, name, type, serialization_format FROM topics"));
    std::string ids;
    for (;;) {
      SCANCAL_ASSIGN_OR_RETURN(const bool more, Step());
      if (!more) break;
      const int64_t id = sqlite3_column_int64(statement_.get(), 0);
      RosTopic topic = {Text(1), Text(2)};
      if (const size_t at = topic.type.find("/msg/"); at != std::string::npos) topic.type.erase(at, 4);
      topics_.push_back(topic);
      if (topic.type != kLaserScan && topic.type != kJointState) continue;
      if (const std::string format = Text(3); format != "cdr")
        return Error{path_.string() + ": topic " + Quoted(topic.name) + ": found the serialization format " +
                     Quoted(format) + ", expected cdr"};
      ids += (ids.empty() ? "" : ", ") + std::to_string(id);
      wanted_[id] = std::move(topic);
    }
    return Prepare("SELECT topic_id, data FROM messages WHERE topic_id IN (" + ids + ")");
  }

  std::filesystem::path path_;
  int64_t size_ = 0, read_ = 0, pieces_ = 0;
  Database database_{nullptr, &sqlite3_close};
  Statement statement_{nullptr, &sqlite3_finalize};
  bool at_end_ = false;
  std::vector<RosTopic> topics_;
  std::map<int64_t, RosTopic> wanted_;
};

}  // namespace

Result<std::unique_ptr<RosBag>> OpenRos2Bag(const std::filesystem::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(const DecodedFile file, DecodedFile::Open(path));
  if (!file.sized()) return Error{path.string() + ": found a ROS 2 bag that is packed, expected it unpacked"};
  auto bag = std::make_unique<Ros2Bag>(path, file.size());
  SCANCAL_RETURN_IF_ERROR(bag->Open());
  return std::unique_ptr<RosBag>(std::move(bag));
}

#else

Result<std::unique_ptr<RosBag>> OpenRos2Bag(const std::filesystem::path& path) {
  return Error{path.string() +
               ": found a ROS 2 bag in SQLite, which this program was built without; install "
               "libsqlite3-dev and build it again, or convert it to a ROS 1 bag"};
}

#endif

}  // namespace scancal
