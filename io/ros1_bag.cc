// ROS 1 bags, format 2.0: records of a header (fields name=value) and data; messages lie in chunks.
#include <archive.h>
#include <archive_entry.h>
#include <algorithm>
#include <cstring>
#include <map>
#include <optional>
#include <utility>
#include "io/decoded_file.h"
#include "io/message.h"
#include "io/ros.h"

namespace scancal {
namespace {

constexpr std::string_view kRos1Start = "#ROSBAG V2.0\n";
enum : char { kOpMessage = 2, kOpChunk = 5, kOpConnection = 7 };

uint32_t LittleEndian(const char* bytes) {
  uint32_t number = 0;
  std::memcpy(&number, bytes, sizeof number);
  return number;
}

using Fields1 = std::map<std::string, std::string_view>;

// Of a record's header, or of a connection's data; what is no field ends it.
Fields1 FieldsOf(std::string_view header) {
  Fields1 fields;
  while (header.size() >= 4) {
    const size_t size = LittleEndian(header.data());
    header.remove_prefix(4);
    if (size > header.size()) break;
    const std::string_view field = header.substr(0, size);
    header.remove_prefix(size);
    const size_t equals = field.find('=');
    if (equals != std::string_view::npos) fields[std::string(field.substr(0, equals))] = field.substr(equals + 1);
  }
  return fields;
}

std::string TextIn(const Fields1& fields, const char* name) {
  const auto found = fields.find(name);
  return found == fields.end() ? "" : std::string(found->second);
}

std::optional<uint32_t> NumberIn(const Fields1& fields, const char* name) {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() != 4) return std::nullopt;
  return LittleEndian(found->second.data());
}

class Ros1Bag : public RosBag {
 public:
  explicit Ros1Bag(DecodedFile file) : file_(std::move(file)) {}
  std::vector<RosTopic> topics() const override {
    std::vector<RosTopic> topics;
    for (const auto& [number, topic] : connections_) topics.push_back(topic);
    return topics;
  }
  int64_t bytes_read() const override { return file_.bytes_read(); }
  int64_t bytes_total() const override { return file_.size(); }

  Result<void> ReadStart() {
    SCANCAL_ASSIGN_OR_RETURN(const std::string start, Take(kRos1Start.size()));
    if (start == kRos1Start) return {};
    return Error{file_.name() + ": found other data, expected the line #ROSBAG V2.0 that a ROS 1 bag begins with"};
  }

  Result<bool> Next(RosMessage* message) override {
    for (;;) {
      while (!chunk_rest_.empty()) {
        SCANCAL_ASSIGN_OR_RETURN(const bool found, TakeFromChunk(message));
        if (found) return true;
      }
      SCANCAL_ASSIGN_OR_RETURN(const bool more, NextRecord());
      if (!more) return false;
    }
  }

 private:
  Error CutOff() const {
    return {file_.name() + ": the file is cut off, expected whole records; rosbag reindex mends a bag"};
  }

  // So many bytes: as many as there are are held, whatever is announced.
  Result<std::string> Take(size_t size) {
    constexpr size_t kPiece = size_t{1} << 20;
    std::string bytes;
    while (bytes.size() < size) {
      const size_t had = bytes.size(), piece = std::min(kPiece, size - had);
      bytes.resize(had + piece);
      SCANCAL_ASSIGN_OR_RETURN(const size_t count, file_.Read(bytes.data() + had, piece));
      if (count < piece) return CutOff();
    }
    return bytes;
  }

  // Of the file: a chunk comes into chunk_. False: the file ends.
  Result<bool> NextRecord() {
    char length[4] = {};
    SCANCAL_ASSIGN_OR_RETURN(const size_t count, file_.Read(length, sizeof length));
    if (count == 0) return false;
    if (count < sizeof length) return CutOff();
    SCANCAL_ASSIGN_OR_RETURN(const std::string header, Take(LittleEndian(length)));
    SCANCAL_ASSIGN_OR_RETURN(const std::string size, Take(4));
    const Fields1 fields = FieldsOf(header);
    const std::string op = TextIn(fields, "op");
    if (op.size() != 1)
      return Error{file_.name() + ": found a record without its kind (op), expected a ROS 1 bag, format 2.0"};
    if (op[0] != kOpChunk && op[0] != kOpConnection) {  // an index, or padding
      SCANCAL_RETURN_IF_ERROR(file_.Skip(LittleEndian(size.data())));
      return true;
    }
    SCANCAL_ASSIGN_OR_RETURN(std::string data, Take(LittleEndian(size.data())));
    if (op[0] == kOpConnection) {
      Connect(fields, data);
      return true;
    }
    const std::string compression = TextIn(fields, "compression");
    if (compression == "none" || compression.empty()) {
      chunk_ = std::move(data);
    } else {
      SCANCAL_ASSIGN_OR_RETURN(chunk_, Unpacked(data, compression));
    }
    chunk_rest_ = chunk_;
    return true;
  }

  Result<std::string> Unpacked(const std::string& packed, const std::string& compression) const {
    const std::unique_ptr<archive, decltype(&archive_read_free)> unpacker(archive_read_new(), &archive_read_free);
    const bool known = compression == "bz2"   ? archive_read_support_filter_bzip2(unpacker.get()) == ARCHIVE_OK
                       : compression == "lz4" ? archive_read_support_filter_lz4(unpacker.get()) == ARCHIVE_OK
                                              : false;
    if (!known)
      return Error{file_.name() + ": found a chunk packed as " + Quoted(compression) +
                   ", expected none, bz2 or lz4; rosbag decompress writes it without"};
    archive_read_support_format_raw(unpacker.get());
    const auto damaged = [&] {
      const char* const reason = archive_error_string(unpacker.get());
      return Error{file_.name() + ": a chunk cannot be unpacked from " + compression + ": " +
                   (reason ? reason : "damaged data")};
    };
    archive_entry* entry = nullptr;
    if (archive_read_open_memory(unpacker.get(), packed.data(), packed.size()) != ARCHIVE_OK ||
        archive_read_next_header(unpacker.get(), &entry) != ARCHIVE_OK)
      return damaged();
    constexpr size_t kPiece = size_t{1} << 16, kSmall = size_t{1} << 26, kMostGrowth = 100;
    std::string bytes;
    for (;;) {
      const size_t had = bytes.size();
      bytes.resize(had + kPiece);
      const la_ssize_t count = archive_read_data(unpacker.get(), bytes.data() + had, kPiece);
      if (count < 0) return damaged();
      bytes.resize(had + static_cast<size_t>(count));
      if (count == 0) return bytes;
      if (bytes.size() > kSmall + kMostGrowth * packed.size())
        return Error{file_.name() + ": a chunk grows by more than 100 times as it is unpacked, expected messages"};
    }
  }

  void Connect(const Fields1& fields, std::string_view data) {
    const auto number = NumberIn(fields, "conn");
    if (number) connections_[*number] = {TextIn(fields, "topic"), TextIn(FieldsOf(data), "type")};
  }

  // A record of the chunk; whether it is a message that is wanted.
  Result<bool> TakeFromChunk(RosMessage* message) {
    std::string_view header, data;
    for (std::string_view* part : {&header, &data}) {
      const size_t size = chunk_rest_.size() < 4 ? 0 : LittleEndian(chunk_rest_.data());
      if (chunk_rest_.size() < 4 || size > chunk_rest_.size() - 4)
        return Error{file_.name() + ": found a chunk that ends within a record, expected whole records"};
      *part = chunk_rest_.substr(4, size);
      chunk_rest_.remove_prefix(4 + size);
    }
    const Fields1 fields = FieldsOf(header);
    const std::string op = TextIn(fields, "op");
    if (op == std::string(1, kOpConnection)) Connect(fields, data);
    if (op != std::string(1, kOpMessage)) return false;
    const auto connection = connections_.find(NumberIn(fields, "conn").value_or(0));
    if (connection == connections_.end())
      return Error{file_.name() + ": found a message of a connection that is not described, expected its topic before"};
    const std::string& type = connection->second.type;
    if (type != kLaserScan && type != kJointState) return false;
    *message = {connection->second, data, false};
    return true;
  }

  DecodedFile file_;
  std::map<uint32_t, RosTopic> connections_;
  std::string chunk_;
  std::string_view chunk_rest_;
};

}  // namespace

Result<std::unique_ptr<RosBag>> OpenRos1Bag(const std::filesystem::path& path) {
  SCANCAL_ASSIGN_OR_RETURN(DecodedFile file, DecodedFile::Open(path));
  auto bag = std::make_unique<Ros1Bag>(std::move(file));
  SCANCAL_RETURN_IF_ERROR(bag->ReadStart());
  return std::unique_ptr<RosBag>(std::move(bag));
}

}  // namespace scancal
