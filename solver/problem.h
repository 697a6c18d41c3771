// What the solver sees: quantities with a name, a unit and a scope, and rows of residuals that depend on them. No
// scanner.
#pragma once
#include <Eigen/Core>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace scancal {

enum class Unit { kMm, kRad, kOne };
enum class Scope {
  kSystem,
  kTarget,
  kView,
  kPoint
};  // who shares one value: all | a target | a view (one scan line, one pose) | nobody
enum class Role { kEstimate, kConsider, kHold };

const char* Name(Unit unit);    // "mm", "rad", "1"
const char* Name(Role role);    // "estimate", "consider", "hold"
const char* Name(Scope scope);  // "system", "target", "view", "point"

// A number that the residuals depend on. The model declares name, unit and scope once; role, value and u come from the
// user.
struct Quantity {
  std::string name;
  Unit unit = Unit::kOne;
  Scope scope = Scope::kSystem;
  Role role = Role::kHold;
  double value = 0;       // nominal; mean of the prior
  double u = 0;           // estimate: standard uncertainty of the prior (0: none); consider: of the quantity
  bool in_nodes = false;  // the node storey is exact for it (see Target)
  std::string source;     // its line in the budget; empty: its name
  // Of target scope and considered: whether the targets share one value is not known, and the worse of both counts.
  bool perhaps_shared = false;
  // Of view scope: the views are in an order in which neighbours may err alike, by this much: correlation rho^distance.
  bool in_order = false;
  double neighbour = 0;
  const std::string& Source() const { return source.empty() ? name : source; }
};
using Quantities = std::vector<Quantity>;

int Find(const Quantities& quantities, const std::string& name);  // index, or -1

// Some rows of residuals r(q) of one target: those of one view, or of a few nodes that stand for all its views.
class Rows {
 public:
  virtual ~Rows() = default;
  virtual int size() const = 0;
  virtual int points() const = 0;    // size() / points() rows belong to one point
  virtual double count() const = 0;  // scalar observations behind them: degrees of freedom always count these
  // q: one value per quantity, quantities().size() long. point: values of point scope, points() x quantities row-major,
  // added to q; null for zero. r: size(). jacobian: null, or size() x seeds, column-major: dr/dq of the seeds, where
  // the column of a quantity of point scope is the derivative of each row by its own point's value.
  virtual void Evaluate(const double* q, const double* point, std::span<const int> seeds, double* r,
                        double* jacobian) const = 0;
  // Optional: larger rows of which these are some, in the same order, and the first of these among them. Neighbours are
  // then evaluated at once.
  virtual std::pair<const Rows*, int> PartOf() const { return {nullptr, 0}; }
};

// residual = weight * mix * r(q) + offset. An empty mix is the identity, an empty offset zero.
struct Block {
  std::shared_ptr<const Rows> rows;
  double weight = 1;
  Eigen::MatrixXd mix;
  Eigen::VectorXd offset;
  std::string prior;  // not empty: a prior of that name, with unit noise of its own
  int size() const { return static_cast<int>(mix.size() ? mix.rows() : rows->size()); }
  void Evaluate(const double* q, std::span<const int> seeds, Eigen::VectorXd* r, Eigen::MatrixXd* jacobian) const;
  Eigen::MatrixXd Weighted(const Eigen::Ref<const Eigen::MatrixXd>& rows_of_r) const;     // weight * mix * rows_of_r
  Eigen::MatrixXd WeightedFromLeft(const Eigen::Ref<const Eigen::MatrixXd>& left) const;  // weight * left * mix
};

// The views of one target share its quantities. Where residuals are linear in a few known features, the rows of some
// views in a row also equal a mix of those of a few nodes and a constant: rows(view) = interpolation (rows(nodes), 1),
// hence sum |rows(view)|^2 = |mix rows(nodes) + offset|^2 at every q. Without a constant there is no last column.
struct Target {
  std::string name;
  std::vector<Block> views;  // profile storey; the priors of the target's own quantities come last
  std::vector<Block> nodes;  // node storey; empty if the model has none
  std::vector<std::vector<Eigen::MatrixXd>> interpolation;  // per block of nodes, of each view that it stands for
  void MixNodes();                                          // after the views' weights or mixes have changed
};

// Owns all it refers to.
struct Problem {
  Quantities quantities;
  std::vector<Target> targets;
  std::vector<Block> priors;  // of system quantities

  // One row (q - value) / u for every estimated quantity with a prior, or for these; once the targets are in place.
  void AddPriors();
  void AddPriors(const std::vector<int>& of);
  // All data rows divided by sigma, their common standard deviation; priors keep their own unit noise.
  void WeighEqually(double sigma);
  std::vector<int> With(std::initializer_list<Scope> scopes, Role role) const;
  bool NodesSuffice()
      const;             // every target has nodes, and they are exact for every quantity that is estimated or not zero
  double Count() const;  // observations and priors
};

// Values of the estimated quantities, in the order of Problem::quantities.
struct Estimate {
  Eigen::VectorXd system;
  std::vector<Eigen::VectorXd> targets;  // per target its own
};

Estimate NominalStart(const Problem& problem);  // every quantity at its value
// One value per quantity as target t sees it: nominal, with the estimates in place.
std::vector<double> Values(const Problem& problem, const Estimate& estimate, size_t target);
// The other way: takes what is estimated of the system and of target t from `values`.
void SetValues(const Problem& problem, const std::vector<double>& values, size_t target, Estimate* estimate);

}  // namespace scancal
