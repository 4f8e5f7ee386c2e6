// Runs a fuzz target without libFuzzer, for compilers that have none and for ./check: every file of
// the corpus as it is, then inputs made from them at random; the same ones every time.
//   fuzz_request [-runs=N] [-seed=N] [-max_len=N] [-dict=FILE] CORPUS...
// What ends the program is left in ./crash-input.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

std::string current;  // for the signal handler

void Leave(int signal) {
  const int fd = ::open("crash-input", O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd >= 0 && ::write(fd, current.data(), current.size()) < 0) ::_exit(1);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void Run(std::string input) {
  current = std::move(input);
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(current.data()), current.size());
}

std::string Read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The words of a dictionary as libFuzzer reads them: one per line, in quotes, with \xAB, \\ and
/// \".
std::vector<std::string> Words(const std::string& path) {
  std::vector<std::string> words;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const auto begin = line.find('"'), end = line.rfind('"');
    if (line.starts_with('#') || begin == end) continue;
    std::string word;
    for (std::size_t i = begin + 1; i < end; ++i) {
      if (line[i] == '\\' && line[i + 1] == 'x') {
        word += static_cast<char>(std::stoi(line.substr(i + 2, 2), nullptr, 16));
        i += 3;
      } else {
        word += line[i] == '\\' ? line[++i] : line[i];
      }
    }
    words.push_back(word);
  }
  return words;
}

class Mutator {
 public:
  Mutator(std::vector<std::string> corpus, std::vector<std::string> words, std::uint64_t seed)
      : corpus_(std::move(corpus)), words_(std::move(words)), random_(seed) {}

  std::string Next(std::size_t max_size) {
    std::string input = corpus_[Below(corpus_.size())];
    for (std::size_t edits = 1 + Below(6); edits > 0; --edits) Edit(&input);
    if (input.size() > max_size) input.resize(max_size);
    return input;
  }

 private:
  std::size_t Below(std::size_t end) {
    return end == 0 ? 0 : std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }

  void Edit(std::string* input) {
    const std::size_t at = Below(input->size() + 1);
    const std::size_t length = std::min(Below(64), input->size() - at);
    switch (Below(7)) {
      case 0:
        if (at < input->size()) (*input)[at] = static_cast<char>((*input)[at] ^ (1 << Below(8)));
        break;
      case 1:
        input->erase(at, length);
        break;
      case 2:
        input->insert(at, input->substr(at, length));
        break;
      case 3:
        input->insert(at, std::string(1 + Below(4), static_cast<char>(Below(256))));
        break;
      case 4: {
        constexpr std::string_view kNumbers[] = {
            "0", "-1", "1e999", "1e-320", "nan", "4294967296", "9223372036854775808", "0.1"};
        input->insert(at, kNumbers[Below(std::size(kNumbers))]);
        break;
      }
      case 5:
        if (!words_.empty()) input->replace(at, length, words_[Below(words_.size())]);
        break;
      default: {
        const std::string& other = corpus_[Below(corpus_.size())];
        const std::size_t from = Below(other.size() + 1);
        input->replace(at, length, other, from, Below(256));
      }
    }
  }

  std::vector<std::string> corpus_, words_;
  std::mt19937_64 random_;
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> corpus, words;
  std::size_t runs = 10000, max_size = 65536;
  std::uint64_t seed = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::string value = word.substr(std::min(word.find('=') + 1, word.size()));
    if (word.starts_with("-runs=")) runs = std::stoull(value);
    if (word.starts_with("-max_len=")) max_size = std::stoull(value);
    if (word.starts_with("-seed=")) seed = std::stoull(value);
    if (word.starts_with("-dict=")) words = Words(value);
    if (word.starts_with("-")) continue;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(word)) files.push_back(entry);
    std::ranges::sort(files);
    for (const auto& file : files) corpus.push_back(Read(file));
  }
  if (corpus.empty()) {
    std::fprintf(stderr, "a directory with a corpus is needed\n");
    return 2;
  }
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) std::signal(signal, Leave);
  const auto start = std::chrono::steady_clock::now();
  for (const std::string& input : corpus) Run(input);
  Mutator mutator(corpus, words, seed);
  for (std::size_t i = 0; i < runs; ++i) Run(mutator.Next(max_size));
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("%zu inputs in %.1f s\n", corpus.size() + runs, s);
  return 0;
}
