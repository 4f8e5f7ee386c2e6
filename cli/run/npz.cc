#include "cli/run/npz.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "cli/run/write_failure.h"

namespace regrasp::run {
namespace {

/// Without the extensions of the format, sizes have 32 bits.
constexpr double kMaxBytes = 0xf0000000u;

template <typename T>
void Put(std::string* out, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i)
    out->push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i)));
}

std::vector<std::uint32_t> CodePoints(const std::string& utf8) {
  std::vector<std::uint32_t> points;
  for (const unsigned char c : utf8) {
    if (c < 0x80)
      points.push_back(c);
    else if (c >= 0xc0)
      points.push_back(c & (c >= 0xf0 ? 0x07 : c >= 0xe0 ? 0x0f : 0x1f));
    else if (!points.empty())
      points.back() = points.back() << 6 | (c & 0x3f);
  }
  return points;
}

}  // namespace

Npz::Npz(const std::string& path) : path_(path), out_(path, std::ios::binary) {
  if (!out_) FailToWrite(path);
}

void Npz::Add(const std::string& name, const std::vector<std::size_t>& shape,
              const std::vector<double>& values) {
  std::string data(values.size() * sizeof(double), '\0');
  if (!values.empty()) std::memcpy(data.data(), values.data(), data.size());
  AddArray(name, "<f8", shape, data);
}

void Npz::AddBools(const std::string& name, const std::vector<std::size_t>& shape,
                   const std::string& values) {
  AddArray(name, "|b1", shape, values);
}

void Npz::AddText(const std::string& name, const std::vector<std::string>& values) {
  std::vector<std::vector<std::uint32_t>> texts;
  std::size_t width = 1;
  for (const std::string& value : values) {
    texts.push_back(CodePoints(value));
    width = std::max(width, texts.back().size());
  }
  if (texts.size() * 4.0 * static_cast<double>(width) > kMaxBytes) TooLarge();
  std::string data;
  for (auto& text : texts) {
    text.resize(width);
    for (const std::uint32_t point : text) Put(&data, point);
  }
  AddArray(name, "<U" + std::to_string(width), {values.size()}, data);
}

void Npz::TooLarge() const {
  throw std::runtime_error(path_ + " would be larger than 4 GB: use csv or mcap");
}

void Npz::AddArray(const std::string& name, const std::string& type,
                   const std::vector<std::size_t>& shape, const std::string& data) {
  std::string dictionary = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (";
  for (const std::size_t n : shape) dictionary += std::to_string(n) + ",";
  dictionary += "), }";
  dictionary.resize((10 + dictionary.size() + 1 + 63) / 64 * 64 - 10 - 1, ' ');
  dictionary += '\n';
  std::string member = "\x93NUMPY";
  Put<std::uint16_t>(&member, 1);  // version 1.0
  Put<std::uint16_t>(&member, dictionary.size());
  member += dictionary + data;

  if (static_cast<double>(member.size()) > kMaxBytes) TooLarge();
  const std::string file = name + ".npy";
  const auto crc = ::crc32_z(0, reinterpret_cast<const Bytef*>(member.data()), member.size());
  std::string common;  // what the local header and the directory share
  Put<std::uint16_t>(&common, 20);
  Put<std::uint16_t>(&common, 0x800);     // UTF-8 names
  Put<std::uint16_t>(&common, 0);         // stored
  Put<std::uint32_t>(&common, 0x210000);  // 1980-01-01 00:00
  Put<std::uint32_t>(&common, crc);
  Put<std::uint32_t>(&common, member.size());
  Put<std::uint32_t>(&common, member.size());
  Put<std::uint16_t>(&common, file.size());
  Put<std::uint16_t>(&common, 0);
  std::string local = std::string("PK\3\4") + common + file;
  directory_ += "PK\1\2";
  Put<std::uint16_t>(&directory_, 20);
  directory_ += common;
  Put<std::uint16_t>(&directory_, 0);
  Put<std::uint32_t>(&directory_, 0);
  Put<std::uint32_t>(&directory_, 0);
  Put<std::uint32_t>(&directory_, offset_);
  directory_ += file;
  if (static_cast<double>(offset_) + static_cast<double>(local.size() + member.size()) >
          kMaxBytes ||
      members_ == UINT16_MAX)
    TooLarge();
  out_ << local << member;
  offset_ += static_cast<std::uint32_t>(local.size() + member.size());
  ++members_;
}

void Npz::Finish() {
  std::string end = "PK\5\6";
  Put<std::uint32_t>(&end, 0);
  Put<std::uint16_t>(&end, members_);
  Put<std::uint16_t>(&end, members_);
  Put<std::uint32_t>(&end, directory_.size());
  Put<std::uint32_t>(&end, offset_);
  Put<std::uint16_t>(&end, 0);
  out_ << directory_ << end;
  out_.close();
  if (!out_) FailToWrite(path_);
}

}  // namespace regrasp::run
