#include "cli/help/examples.h"

namespace regrasp::cli {
namespace {

// clang-format off
constexpr Example kExamples[] = {
    {"", "regrasp up --speed max", "a daemon of your own, as fast as it can"},
    {"", "regrasp grasp --wait", "close the hand on the object"},
    {"", "regrasp explore ring --wait", "let the ring finger improve the grasp"},
    {"", "regrasp rotate --angle 90 --wait", "turn the object by a quarter"},
    {"", "regrasp down", "stop the daemon"},

    {"up", "regrasp up", "in real time"},
    {"up", "regrasp up --speed max --seed 7", "as fast as it can, other noise"},
    {"up", "regrasp up --object egg --noise coarse", "an egg, and bad sensors"},
    {"down", "regrasp down", "stop the daemon"},
    {"demo", "regrasp demo -o figures", "the figures and claims of the paper"},

    {"grasp", "regrasp grasp --wait", "until the object is held"},
    {"release", "regrasp release --wait", "until the hand is open"},
    {"rotate", "regrasp rotate --angle 90 --wait", "a quarter turn about the hand's z"},
    {"rotate", "regrasp rotate --turns 1 --axis 0,0,-1 --wait", "once round, the other way"},
    {"rotate", "regrasp rotate --continuous", "until regrasp stop"},
    {"move", "regrasp move --by 0,0,5 --wait", "5 mm along z, without a regrasp"},
    {"move", "regrasp move --by 2,0,0 --turn 0,0,-15 --wait", "a shift and a turn at once"},
    {"explore", "regrasp explore ring --wait", "until its grasp gets no better"},
    {"explore", "regrasp explore middle --criterion switched --seed 3 --max-cycles 6000 --wait", "switched measures, another start"},
    {"stop", "regrasp stop", "end what goes on, keep holding"},
    {"pause", "regrasp pause", "stop the clock"},
    {"resume", "regrasp resume", "let it run again"},
    {"step", "regrasp pause && regrasp step 100 --wait", "a tenth of a second, then stand still"},
    {"step", "regrasp pause && regrasp grasp && regrasp step --until-job-ends --wait", "a whole job, tick by tick"},
    {"reset", "regrasp reset --seed 7", "a new run with other noise"},
    {"reset", "regrasp reset --object egg", "a new run with another object"},
    {"noise show", "regrasp noise show", "all levels"},
    {"noise set", "regrasp noise set --position 2 --normal 5", "contacts off by 2 mm and 5 degrees"},
    {"noise set", "regrasp noise set --position-bias 1 --latency 0.005", "a sensor mounted wrongly, and late"},
    {"noise preset", "regrasp noise preset coarse", "every level at once"},
    {"noise off", "regrasp noise off", "perfect sensors"},
    {"push", "regrasp push --force 0,0.3,0 --duration 0.2", "0.3 N along y for 0.2 s"},
    {"param list", "regrasp param list", "everything that can be set"},
    {"param list", "regrasp param list gait", "a group"},
    {"param list", "regrasp param list --changed", "what differs from the defaults"},
    {"param get", "regrasp param get object.friction", "value, unit, range, meaning"},
    {"param set", "regrasp param set object.friction 0.5", "a smoother object"},
    {"param set", "regrasp param set gravity 0,0,-1.62", "on the moon"},
    {"param set", "regrasp param set gait.mode exploring", "a word"},
    {"param reset", "regrasp param reset gait", "a group back to its defaults"},
    {"param reset", "regrasp param reset", "all of them"},
    {"param save", "regrasp param save mine.toml", "what differs from the defaults"},
    {"param load", "regrasp param load mine.toml", "the same again"},

    {"status", "regrasp status", "state, time, noise, job"},
    {"status", "regrasp --json status", "everything, for scripts"},
    {"contacts", "regrasp contacts", "what the controller senses"},
    {"contacts", "regrasp --csv contacts > contacts.csv", "for a spreadsheet"},
    {"joints", "regrasp joints", "angles, torques, limits"},
    {"quality", "regrasp quality", "manipulability, stability, load margin"},
    {"shape", "regrasp shape", "what touching has revealed of the object"},
    {"shape", "regrasp shape -o felt.ply", "as a mesh, with what is unknown"},
    {"truth", "regrasp --json truth", "what the controller does not see"},
    {"job list", "regrasp job list", "what was done"},
    {"job show", "regrasp job show 1", "its record"},
    {"job wait", "regrasp job wait 1", "until it has ended"},
    {"job cancel", "regrasp job cancel 2", "end it"},
    {"events", "regrasp events", "the latest"},
    {"events", "regrasp events -f", "and those to come, until Ctrl-C"},
    {"watch", "regrasp watch quality --rate 5 --count 10", "five a second, ten of them"},
    {"watch", "regrasp --json watch truth --count 2", "JSON, one line each"},

    {"plot", "regrasp plot quality -o quality.png", "the last ten minutes as curves"},
    {"plot", "regrasp plot quality --show", "here in the terminal"},
    {"plot", "regrasp plot scene -o scene.png", "the hand as it is now"},
    {"plot", "regrasp plot shape -o shape.pdf --size 180", "the surface as felt, from two sides"},

    {"experiment exploration", "regrasp experiment exploration --finger ring --seeds 10 -o ring", "ten runs, a table, a picture"},
    {"experiment rotation", "regrasp experiment rotation --turns 1 --seeds 10 -o turns", "ten turns"},
    {"experiment zoo", "regrasp experiment zoo --objects zoo_pear,zoo_lens -n 5 -o zoo", "two objects, both gaits, paired"},
    {"experiment exploration", "regrasp experiment exploration --estimator least_squares,secant -n 30 -o study", "two estimators, same starts"},
    {"experiment rotation", "regrasp experiment rotation --set object.friction=0.4,0.6,0.8 -n 10 -o mu", "three settings, same seeds"},
    {"experiment prediction", "regrasp experiment prediction -n 2 -o foretold", "what foretells a failure; half an hour"},
    {"experiment noise-sweep", "regrasp experiment noise-sweep --finger ring --seeds 5 -o noise", "from perfect to bad sensors"},
    {"experiment paper", "regrasp experiment paper -o paper", "the reproduction report, an hour or so"},
    {"experiment merge", "regrasp experiment merge part1 part2 -o all", "join what two machines made"},

    {"top", "regrasp top", "everything at once, ten times a second"},
    {"shell", "regrasp shell", "commands one after the other, with Tab"},
    {"shell", "echo status | regrasp shell", "or out of a pipe"},
    {"record start", "regrasp record start", "from now on"},
    {"record stop", "regrasp record stop", "close the file"},
    {"record list", "regrasp record list", "the files there are"},
    {"replay", "regrasp replay run-001.mcap", "run it again and compare every state"},
    {"export", "regrasp export run-001.mcap --format csv -o run-001", "tables, units in the header"},
    {"video", "regrasp video run-001.mcap -o run-001.mp4", "scene and curves as a film"},
    {"checkpoint save", "regrasp checkpoint save start", "keep this state"},
    {"checkpoint restore", "regrasp checkpoint restore start", "go on from there"},
    {"checkpoint list", "regrasp checkpoint list", "the states there are"},

    {"hand check", "regrasp hand check shadow", "a hand of the search path"},
    {"hand check", "regrasp hand check my_hand.urdf -o my_hand.png", "a file, and its picture"},
    {"hand new", "regrasp hand new my_hand.urdf -o my_hand.toml", "then: up --hand my_hand.toml"},
    {"hand new", "regrasp hand new my_hand.urdf -o big.toml --object-size 60 --seed 2", "for a larger ball"},

    {"object show", "regrasp object show egg", "an object of the search path"},
    {"object show", "regrasp object show my_object.urdf -o my_object.png", "a file, and its picture"},
    {"object show", "regrasp object show my_object.urdf --inertia-from-shape", "its inertia computed"},

    {"evaluate", "regrasp evaluate grasp.json", "measures of a grasp in a file"},
    {"call", "regrasp call status", "any method of the wire"},
    {"call", R"(regrasp call describe '{"method": "explore"}')", "with parameters"},
    {"doctor", "regrasp doctor", "is everything in order?"},
    {"bench", "regrasp bench --seconds 1", "how fast is this machine?"},
    {"config show", "regrasp config show --origin", "every value and where it comes from"},
    {"config check", "regrasp config check hand.toml", "is the file right?"},
    {"completion", "eval \"$(regrasp completion bash)\"", "for this shell"},
    {"version", "regrasp version", "of this program"},
    {"version", "regrasp -v version", "and of the daemon"},
    {"help", "regrasp help explore", "all about one command"},
};
// clang-format on

}  // namespace

std::vector<Example> ExamplesOf(std::string_view words) {
  std::vector<Example> found;
  for (const Example& example : kExamples)
    if (example.words == words) found.push_back(example);
  return found;
}

}  // namespace regrasp::cli
