"""Optimizers of both bases and the grasp together: one algorithm a file, ask / tell."""

from mmplan.optimizers.archive import Archive, Triple
from mmplan.optimizers.bases import BasePlacements
from mmplan.optimizers.blockwise import Blockwise
from mmplan.optimizers.cmaes import CmaEs
from mmplan.optimizers.coevolution import CoEvolution
from mmplan.optimizers.differential_evolution import DifferentialEvolution
from mmplan.optimizers.nevergrad_portfolio import NevergradPortfolio
from mmplan.optimizers.optimizer import (
    Optimizer,
    OptimizerFactory,
    Queries,
    SearchSpace,
)
from mmplan.optimizers.random_sampling import RandomSampling
from mmplan.optimizers.run import Optimization, optimize, search_space

OPTIMIZERS: dict[str, OptimizerFactory] = {
    "coevolution": CoEvolution,
    "random": RandomSampling,
    "blockwise": Blockwise,
    "cmaes": CmaEs,
    "differential_evolution": DifferentialEvolution,
    "nevergrad": NevergradPortfolio,
}

__all__ = [
    "OPTIMIZERS",
    "Archive",
    "BasePlacements",
    "Blockwise",
    "CmaEs",
    "CoEvolution",
    "DifferentialEvolution",
    "NevergradPortfolio",
    "Optimization",
    "Optimizer",
    "OptimizerFactory",
    "Queries",
    "RandomSampling",
    "SearchSpace",
    "Triple",
    "optimize",
    "search_space",
]
