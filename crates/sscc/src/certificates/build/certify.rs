//! Computes all certificates: the pair tree, then the radii of nodes (paper, section 5.2).

use std::sync::Arc;

use super::executor::{Executor, ThreadExecutor};
use super::node_radii::NodeRadii;
use super::pair_tree_builder::PairTreeBuilder;
use super::preparation::Preparation;
use crate::arithmetic::check_arithmetic;
use crate::certificates::pair_tree::{PairEntry, PairTree};
use crate::certificates::{CertificateParts, Certificates, CertifyOptions, LocalCertificates};
use crate::hierarchy::{Hierarchy, Node};
use crate::parallel::on_threads;
use crate::{Error, Progress, ReducedModel};

impl Certificates {
    /// Computes the hierarchy and all certificates of a model: every `R_n`, `R_nm` for the children of the root (paper,
    /// section 5.2), the pair tree within [`CertifyOptions::budget`], and, without a clearance, local certificates in the memory
    /// that both budgets leave ([`CertifyOptions::local_budget`]).
    ///
    /// # Errors
    /// - When this thread's arithmetic is not that of IEEE 754 ([`Error::Arithmetic`]).
    /// - When an option is out of range, or metric, centre or contact filter do not fit the model.
    /// - When too many pairs collide at rest, or collide or are nearer than the clearance at the centre, when too many
    ///   are to be ignored, or when too many are within the rings of the clearance.
    /// - When `progress` cancels.
    pub fn compute(
        model: &ReducedModel,
        options: &CertifyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        check_arithmetic()?;
        on_threads(options.threads, || {
            let preparation = Preparation::new(model, options, progress)?;
            let mut executor = ThreadExecutor { preparation: &preparation, progress };
            let radii = CertifiedRadii::compute(&preparation, options.budget, &mut executor, progress)?;
            radii.into_certificates(model, options, preparation, progress)
        })
    }
}

/// The radii of a model that was prepared.
pub(crate) struct CertifiedRadii {
    radii: NodeRadii,
    pair_tree: PairTree,
}

impl CertifiedRadii {
    /// Runs all stages. `budget` is the number of bytes of the pair tree for each triangle.
    pub(crate) fn compute(
        preparation: &Preparation,
        budget: usize,
        executor: &mut dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let hierarchy = &preparation.hierarchy;
        let entries = budget.saturating_mul(hierarchy.order().len()) / size_of::<PairEntry>();
        let builder = PairTreeBuilder::build(preparation, entries, executor)?;
        let radii = NodeRadii::compute(preparation, &builder, executor, progress)?;
        let pair_tree = builder.finish(hierarchy, &radii.nodes);
        Ok(Self { radii, pair_tree })
    }

    /// Returns the bytes of the hierarchy, the radii of its nodes and the pair tree in a file: each node has a radius, a state of
    /// one byte and a start in the pair tree.
    fn bytes(&self, hierarchy: &Hierarchy) -> usize {
        let node = size_of::<Node>() + size_of::<f64>() + size_of::<u8>() + size_of::<u32>();
        let order = size_of_val(hierarchy.order());
        hierarchy.nodes().len() * node + order + self.pair_tree.len() * size_of::<PairEntry>()
    }

    /// Returns the certificates of the model that was prepared, with local certificates, which it computes on the threads of the
    /// current pool.
    ///
    /// # Errors
    /// When `progress` cancels.
    pub(crate) fn into_certificates(
        self,
        model: &ReducedModel,
        options: &CertifyOptions,
        preparation: Preparation,
        progress: &dyn Progress,
    ) -> Result<Certificates, Error> {
        // Local certificates prove that parts do not collide, not how far apart they stay.
        let local = if options.local_budget == 0 || options.clearance.is_some() {
            LocalCertificates::default()
        } else {
            let both = options.budget.saturating_add(options.local_budget);
            let bytes = both.saturating_mul(model.mesh().faces().len());
            let left = bytes.saturating_sub(self.bytes(&preparation.hierarchy));
            preparation.local_certificates(model, left, progress)?
        };
        let Preparation { digest, scope, hierarchy, rest_collisions, epsilon, .. } = preparation;
        Ok(Certificates::new(CertificateParts {
            digest,
            scope: Arc::new(scope),
            rest_collisions,
            hierarchy,
            epsilon,
            global_radius: self.radii.cap,
            node_radii: self.radii.nodes,
            root_pair_radii: self.radii.root_pairs,
            pair_tree: self.pair_tree,
            local: Arc::new(local),
        }))
    }
}
