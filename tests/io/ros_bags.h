// Bags of ROS 1 and 2 as their documented layouts say, for tests.
#pragma once
#ifdef SCANCAL_SQLITE
#include <sqlite3.h>
#endif
#include <archive.h>
#include <archive_entry.h>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>
#include "tests/io/temporary_folder.h"

namespace scancal {

// A message as ROS 1 serializes it, or as CDR, in either order of bytes.
class Serialized {
 public:
  explicit Serialized(bool cdr, bool big = false) : cdr_(cdr), big_(big) {
    if (cdr) bytes_ = {0, static_cast<char>(big ? 0 : 1), 0, 0};
  }
  template <class Number>
  Serialized& Add(Number number) {
    while (cdr_ && (bytes_.size() - 4) % sizeof number > 0) bytes_ += '\0';
    std::string bytes(reinterpret_cast<const char*>(&number), sizeof number);
    bytes_.append(big_ ? std::string(bytes.rbegin(), bytes.rend()) : bytes);
    return *this;
  }
  Serialized& Add(const std::string& text) {
    Add(static_cast<uint32_t>(text.size() + (cdr_ ? 1 : 0)));
    bytes_ += text;
    if (cdr_) bytes_ += '\0';
    return *this;
  }
  template <class Number>
  Serialized& Add(const std::vector<Number>& list) {
    Add(static_cast<uint32_t>(list.size()));
    for (const Number& each : list) Add(each);
    return *this;
  }
  Serialized& Header(double time_s) {
    if (!cdr_) Add(uint32_t{7});
    const auto seconds = static_cast<uint32_t>(time_s);
    return Add(seconds).Add(static_cast<uint32_t>((time_s - seconds) * 1e9 + 0.5)).Add(std::string("laser"));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  bool cdr_, big_;
  std::string bytes_;
};

struct BagMessage {
  std::string topic, type, data;
};

// Rays at -0.5, -0.25, ... rad; from 0.5 to 10 m count.
inline BagMessage ScanMessage(bool cdr, double time_s, const std::vector<float>& ranges, float time_increment = 0,
                              const std::string& topic = "/scan", bool big = false) {
  Serialized message(cdr, big);
  message.Header(time_s).Add(-0.5F).Add(0.5F).Add(0.25F).Add(time_increment).Add(0.1F).Add(0.5F).Add(10.0F);
  message.Add(ranges).Add(std::vector<float>());
  return {topic, cdr ? "sensor_msgs/msg/LaserScan" : "sensor_msgs/LaserScan", message.bytes()};
}

inline BagMessage JointMessage(bool cdr, double time_s, const std::vector<std::string>& names,
                               const std::vector<double>& positions, const std::string& topic = "/joint_states") {
  Serialized message(cdr);
  message.Header(time_s).Add(names).Add(positions).Add(std::vector<double>()).Add(std::vector<double>());
  return {topic, cdr ? "sensor_msgs/msg/JointState" : "sensor_msgs/JointState", message.bytes()};
}

inline std::string Packed(const std::string& bytes, int (*filter)(archive*)) {
  std::string packed(bytes.size() + 10'000, '\0');
  size_t size = 0;
  archive* const writer = archive_write_new();
  archive_write_set_format_raw(writer);
  filter(writer);
  archive_write_set_bytes_in_last_block(writer, 1);
  archive_write_open_memory(writer, packed.data(), packed.size(), &size);
  archive_entry* const entry = archive_entry_new();
  archive_entry_set_filetype(entry, AE_IFREG);
  archive_entry_set_pathname(entry, "chunk");
  archive_write_header(writer, entry);
  archive_write_data(writer, bytes.data(), bytes.size());
  archive_entry_free(entry);
  archive_write_close(writer);
  archive_write_free(writer);
  packed.resize(size);
  return packed;
}

// compression: none, bz2, lz4, or a name alone.
inline std::string Ros1BagOf(const std::vector<BagMessage>& messages, const std::string& compression = "none") {
  const auto number = [](size_t value) {
    const auto small = static_cast<uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&small), sizeof small);
  };
  const auto field = [&](const std::string& name, const std::string& value) {
    return number(name.size() + 1 + value.size()) + name + "=" + value;
  };
  const auto record = [&](const std::string& header, const std::string& data) {
    return number(header.size()) + header + number(data.size()) + data;
  };
  const auto op = [&](char code) { return field("op", std::string(1, code)); };
  std::string chunk;
  std::vector<std::string> topics;
  for (const BagMessage& message : messages) {
    const auto found = std::find(topics.begin(), topics.end(), message.topic);
    const std::string connection = field("conn", number(static_cast<size_t>(found - topics.begin())));
    if (found == topics.end()) {
      topics.push_back(message.topic);
      chunk += record(op(7) + connection + field("topic", message.topic),
                      field("topic", message.topic) + field("type", message.type) + field("md5sum", "*") +
                          field("message_definition", "Header header"));
    }
    chunk += record(op(2) + connection + field("time", std::string(8, '\0')), message.data);
  }
  const std::string packed = compression == "bz2"   ? Packed(chunk, &archive_write_add_filter_bzip2)
                             : compression == "lz4" ? Packed(chunk, &archive_write_add_filter_lz4)
                                                    : chunk;
  return "#ROSBAG V2.0\n" +
         record(op(3) + field("index_pos", std::string(8, '\0')) + field("conn_count", number(topics.size())) +
                    field("chunk_count", number(1)),
                std::string(300, ' ')) +
         record(op(5) + field("compression", compression) + field("size", number(chunk.size())), packed) +
         record(op(4) + field("ver", number(1)) + field("conn", number(0)) + field("count", number(0)), "");
}

#ifdef SCANCAL_SQLITE
// The tables that rosbag2_storage_sqlite3 makes.
inline std::filesystem::path WriteRos2Bag(const TemporaryFolder& folder, const std::string& name,
                                          const std::vector<BagMessage>& messages, const std::string& format = "cdr") {
  const std::filesystem::path path = folder.Write(name, "");
  sqlite3* bag = nullptr;
  sqlite3_open(path.c_str(), &bag);
  std::string sql =
      "PRAGMA synchronous=OFF;PRAGMA journal_mode=OFF;"
      "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY,ros_distro TEXT NOT NULL);"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT "
      "NULL,offered_qos_profiles TEXT NOT NULL,type_description_hash TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL,data BLOB NOT "
      "NULL);CREATE INDEX timestamp_idx ON messages (timestamp ASC);BEGIN;";
  std::vector<std::string> topics;
  for (const BagMessage& message : messages) {
    const auto found = std::find(topics.begin(), topics.end(), message.topic);
    const std::string id = std::to_string(found - topics.begin() + 1);
    if (found == topics.end()) {
      topics.push_back(message.topic);
      sql += "INSERT INTO topics VALUES(" + id + ",'" + message.topic + "','" + message.type + "','" + format +
             "','','');";
    }
    std::string hexadecimal;
    for (const char c : message.data) {
      constexpr char kDigits[] = "0123456789abcdef";
      const auto byte = static_cast<unsigned char>(c);
      hexadecimal += {kDigits[byte >> 4U], kDigits[byte & 15U]};
    }
    sql += "INSERT INTO messages(topic_id,timestamp,data) VALUES(" + id + ",0,x'" + hexadecimal + "');";
  }
  sqlite3_exec(bag, (sql + "COMMIT;").c_str(), nullptr, nullptr, nullptr);
  sqlite3_close(bag);
  return path;
}
#endif

}  // namespace scancal
