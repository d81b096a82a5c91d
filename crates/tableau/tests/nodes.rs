//! Nodes and weights against what is known of them from elsewhere.

#![allow(clippy::unwrap_used)]

use equip_scalar::Float;
use equip_tableau::Gauss;

/// Abramowitz and Stegun, Handbook of Mathematical Functions, table 25.4, n = 20, on [−1, 1]: (x, w).
const TABLE_25_4: [(&str, &str); 10] = [
    ("0.076526521133497333755", "0.152753387130725850698"),
    ("0.227785851141645078080", "0.149172986472603746788"),
    ("0.373706088715419560673", "0.142096109318382051329"),
    ("0.510867001950827098004", "0.131688638449176626898"),
    ("0.636053680726515025453", "0.118194531961518417312"),
    ("0.746331906460150792614", "0.101930119817240435037"),
    ("0.839116971822218823395", "0.083276741576704748725"),
    ("0.912234428251325905868", "0.062672048334109063570"),
    ("0.963971927277913791268", "0.040601429800386941331"),
    ("0.993128599185094924786", "0.017614007139152118312"),
];

#[test]
fn twenty_nodes_agree_with_the_published_table() {
    table::<f64>();
}

fn table<T: Float>() {
    let gauss = Gauss::<T>::new(20).unwrap();
    let half = T::ratio(1, 2);
    // 20 digits printed in f64 or 3 ulp measured, whichever is larger, × 4.
    let tolerance = T::int(12) * T::EPSILON + T::decimal("2e-20").unwrap();
    for (k, (x, w)) in TABLE_25_4.into_iter().enumerate() {
        let (x, w) = (T::decimal(x).unwrap(), T::decimal(w).unwrap());
        assert!((gauss.nodes()[10 + k] - half * (x + T::int(1))).abs() < tolerance);
        assert!((gauss.weights()[10 + k] - half * w).abs() < tolerance);
    }
}
